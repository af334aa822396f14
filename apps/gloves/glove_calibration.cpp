#include "gloves/glove_calibration.hpp"

namespace nendo::gloves {

void add_calibration_options(cli::Command& command, CalibrationOptions& options, bool two_gloves) {
  command.add_option("--user", options.user, "The wearer, whose stored calibration is used");
  if (two_gloves) {
    command.add_option("--left-user", options.left_user,
                       "The wearer of the left glove, if it is another one");
    command.add_option("--right-user", options.right_user, "The same for the right glove");
  }
  command.add_option("--calibration", options.calibration,
                     "A file or stored name to use instead (see nendo calibration), or none");
  command.add_flag("--adapt", options.adapt,
                   "Learn while the glove is used: the wearer's ranges, or, with the --user or the "
                   "--calibration of a hand that was calibrated by poses, how far the glove slips; "
                   "with --user, nendo run keeps what was learned, and continues from it");
}

Result<void> check(const CalibrationOptions& options) {
  if (!options.adapt || options.calibration != "none") return {};
  return Error{Errc::usage, "--calibration none: --adapt begins without a calibration by itself; "
                            "leave out one of the two"};
}

Result<void> HandLength::check() const {
  constexpr double min_mm = 100.0;
  constexpr double max_mm = 250.0;
  if (!length_mm || (*length_mm >= min_mm && *length_mm <= max_mm)) return {};
  return Error{Errc::usage, "--hand-length: use 100 to 250 millimetres, from the wrist's crease to "
                            "the tip of the middle finger"};
}

hand::HandSize HandLength::size(const hand::HandSize& known) const noexcept {
  if (!length_mm) return known;
  const double length_m = 1e-3 * *length_mm;
  return {length_m, length_m / known.length_m * known.breadth_m, known.shape};
}

void add_hand_length(cli::Command& command, HandLength& length) {
  command.add_millimetres("--hand-length", length.length_mm,
                          "The wearer's hand in millimetres or as 18.5cm, from the wrist's crease "
                          "to the tip of the middle finger, 100 to 250; without it, as the "
                          "calibration says");
}

} // namespace nendo::gloves
