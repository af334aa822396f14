// Whatever the text is, parse_calibration gives an error or a calibration that can be written, and
// reads back to the same bits.

#include <cstdint>
#include <string>
#include <string_view>

#include "laws.hpp"
#include "support/random_calibration.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  const auto wearer = nendo::hand::parse_calibration(text, "fuzz");
  if (!wearer) {
    require_one_line(wearer.error());
    return 0;
  }
  const auto written = nendo::hand::calibration_text(*wearer);
  require(static_cast<bool>(written));
  const auto back = nendo::hand::parse_calibration(*written, "back");
  require(back && nendo::test::same_bits(*back, *wearer));
  return 0;
}
