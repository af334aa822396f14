#pragma once
// Which calibration the glove at hand gets: the one that is asked for, the stored one, or the
// default.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration.hpp>

#include "command.hpp"

namespace nendo::app {

struct CalibrationOptions {
  std::string user;        ///< empty: whoever
  std::string calibration; ///< a NAME of `nendo calibration`, or "none"; empty: what is stored
};

/// The serial number that the glove tells; empty: none.
std::string serial_of(const driver::GloveInfo& glove);

/// --user and --calibration.
void add_calibration_options(Command& command, CalibrationOptions& options);

/// For the hand that the glove is sewn for. Says in one line on standard error which file it is; a
/// simulated glove gets a stored one only if it is asked for. Blocks. Errors: bad_input (no such,
/// another hand's, not readable), usage.
Result<hand::Calibration> calibration_of(const driver::GloveInfo& glove, Side side,
                                         const CalibrationOptions& options);

/// For a glove of the other side than `side` in the place of this one, without a word: a stored
/// one, or the default. Blocks.
hand::Calibration swapped_calibration(const driver::GloveInfo& glove, Side side,
                                      const CalibrationOptions& options);

} // namespace nendo::app
