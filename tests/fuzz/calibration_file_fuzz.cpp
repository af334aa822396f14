// Whatever the text is, parse_calibration gives an error or a calibration that can be written, and
// reads back to the same bits.

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "support/random_calibration.hpp"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto wearer = nendo::hand::parse_calibration(text, "fuzz");
  if (!wearer) {
    const auto& message = wearer.error().message;
    require(message.starts_with("fuzz:") && message.find('\n') == std::string::npos);
    return 0;
  }
  const auto written = nendo::hand::calibration_text(*wearer);
  require(static_cast<bool>(written));
  const auto back = nendo::hand::parse_calibration(*written, "back");
  require(back && nendo::test::same_bits(*back, *wearer));
  return 0;
}
