#pragma once
// Chooses the calibration for a glove: the one that is asked for, the stored one, the default, or
// what is learned while the glove is used.

#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/wearer.hpp>

#include "cli/command.hpp"

namespace nendo::gloves {

struct CalibrationOptions {
  std::string user;        ///< empty: any
  std::string calibration; ///< a NAME of `nendo calibration`, or "none"; empty: what is stored
  bool adapt = false;      ///< learn the wearer's ranges instead
};

/// Returns the serial number that the glove tells, or an empty text.
std::string serial_of(const driver::GloveInfo& glove);

/// Adds the options --user, --calibration and --adapt.
void add_calibration_options(cli::Command& command, CalibrationOptions& options);

/// Fails with usage if the options contradict each other. Call it before a glove is opened.
Result<void> check(const CalibrationOptions& options);

/// Finds the wearer of a glove that is sewn for `side`. For that side the wearer gets the hand that
/// is asked for, stored, or recorded (if the glove replays); one line on standard error tells which
/// file it is. A simulated glove gets a stored hand only if it is asked for. For the other side the
/// wearer gets the stored hand or an average one, and nothing is printed. Blocks. Errors: bad_input
/// (no such file, another hand's, not readable), usage.
Result<hand::Wearer> find_wearer(const driver::GloveInfo& glove, Side side,
                                 const CalibrationOptions& options);

} // namespace nendo::gloves
