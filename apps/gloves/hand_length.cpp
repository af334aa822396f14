#include "gloves/hand_length.hpp"

namespace nendo::gloves {
namespace {

constexpr double least_mm = 100.0;
constexpr double most_mm = 250.0;

} // namespace

Result<void> HandLength::check() const {
  if (!length_mm || (*length_mm >= least_mm && *length_mm <= most_mm)) return {};
  return Error{Errc::usage, "--hand-length: use 100 to 250 millimetres, from the wrist's crease to "
                            "the tip of the middle finger"};
}

hand::HandSize HandLength::size(const hand::HandSize& known) const noexcept {
  if (!length_mm) return known;
  const double length_m = 1e-3 * *length_mm;
  return {length_m, length_m / known.length_m * known.breadth_m};
}

void add_hand_length(cli::Command& command, HandLength& length) {
  command.add_option("--hand-length", length.length_mm,
                     "The wearer's hand in millimetres, from the wrist's crease to the tip of the "
                     "middle finger, 100 to 250; without it, as the calibration says");
}

} // namespace nendo::gloves
