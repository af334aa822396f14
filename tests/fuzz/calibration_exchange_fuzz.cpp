// Whatever the text is, the readers of other programs' calibrations give an error or finite lines
// that a calibration file can hold.

#include "imported_calibration.hpp"

namespace {

void check(const nendo::Result<nendo::hand::ImportedCalibration>& read) {
  check_imported(read);
  if (!read) return;
  const auto exported = nendo::hand::virtualhand_text(read->calibration, {});
  if (exported) require(static_cast<bool>(nendo::hand::parse_virtualhand(exported->text, "fuzz")));
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  (void)nendo::hand::format_of(text);
  check(nendo::hand::parse_virtualhand(text, "fuzz"));
  check(nendo::hand::parse_two_point(text, "fuzz"));
  check(nendo::hand::parse_calibration_csv(text, "fuzz"));
  return 0;
}
