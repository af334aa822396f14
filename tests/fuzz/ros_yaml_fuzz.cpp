// Whatever the text is, the reader of ROS drivers' calibrations in YAML gives an error in one line,
// or finite lines that are written and read back.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <nendo/hand/calibration_exchange.hpp>
#include <nendo/hand/calibration_file.hpp>

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nendo::hand;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto read = parse_ros_yaml(text, "fuzz");
  if (!read) {
    const auto& message = read.error().message;
    require(message.starts_with("fuzz:") && message.find('\n') == std::string::npos);
    return 0;
  }
  for (const std::string& note : read->notes)
    require(note.find('\n') == std::string::npos);
  for (const auto& line : read->calibration.sensors)
    require(std::isfinite(line.angle_rad(nendo::RawCount{65535})));
  WearerCalibration wearer;
  wearer.user = "fuzz";
  wearer.method = "imported";
  wearer.calibration = read->calibration;
  require(static_cast<bool>(calibration_text(wearer)));
  (void)ros_yaml_text(read->calibration, {});
  return 0;
}
