// Whatever the text is, the readers of other programs' calibrations give an error or finite lines
// that a calibration file can hold.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <nendo/hand/calibration_exchange.hpp>
#include <nendo/hand/calibration_file.hpp>

namespace {

using nendo::hand::ImportedCalibration;

void require(bool condition) {
  if (!condition) std::abort();
}

void check(const nendo::Result<ImportedCalibration>& read) {
  if (!read) {
    const auto& message = read.error().message;
    require(message.starts_with("fuzz:") && message.find('\n') == std::string::npos);
    return;
  }
  nendo::hand::WearerCalibration wearer;
  wearer.user = "fuzz";
  wearer.method = "imported";
  wearer.calibration = read->calibration;
  require(static_cast<bool>(nendo::hand::calibration_text(wearer)));
  for (const auto& line : read->calibration.sensors)
    require(std::isfinite(line.angle_rad(nendo::RawCount{65535})));
  const auto exported = nendo::hand::virtualhand_text(read->calibration, {});
  if (exported) require(static_cast<bool>(nendo::hand::parse_virtualhand(exported->text, "fuzz")));
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  (void)nendo::hand::format_of(text);
  check(nendo::hand::parse_virtualhand(text, "fuzz"));
  check(nendo::hand::parse_two_point(text, "fuzz"));
  check(nendo::hand::parse_calibration_csv(text, "fuzz"));
  return 0;
}
