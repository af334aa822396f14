#pragma once
// Which calibration the glove at hand gets: the one that is asked for, the stored one, the default,
// or what is learned while the glove is used.

#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/wearer.hpp>

#include "cli/command.hpp"

namespace nendo::gloves {

struct CalibrationOptions {
  std::string user;        ///< empty: whoever
  std::string calibration; ///< a NAME of `nendo calibration`, or "none"; empty: what is stored
  bool adapt = false;      ///< learn the wearer's ranges instead
};

/// The serial number that the glove tells; empty: none.
std::string serial_of(const driver::GloveInfo& glove);

/// --user, --calibration and --adapt.
void add_calibration_options(cli::Command& command, CalibrationOptions& options);

/// Error: usage, if they contradict each other. To be asked before a glove is opened.
Result<void> check(const CalibrationOptions& options);

/// Finds the wearer of a glove that is sewn for `side`. For that side it is the hand that is asked
/// for, stored, or recorded with a glove that replays; one line on standard error tells which file
/// it is. A simulated glove gets a stored hand only if it is asked for. For the other side it is
/// what is stored, or an average hand, and nothing is told. Blocks. Errors: bad_input (no such
/// file, another hand's, not readable), usage.
Result<hand::Wearer> find_wearer(const driver::GloveInfo& glove, Side side,
                                 const CalibrationOptions& options);

} // namespace nendo::gloves
