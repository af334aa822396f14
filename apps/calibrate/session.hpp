#pragma once
// A guided calibration at a terminal: shows the poses, watches the glove, obeys keys.

#include <string>

#include <nendo/driver/glove.hpp>

#include "calibrate/guide.hpp"

namespace nendo::calibrate {

enum class SessionEnd : std::uint8_t {
  complete, ///< every pose was taken or skipped
  written,  ///< the wearer wants what there is
  quit,     ///< by key, signal, or a terminal that is gone
};

/// Runs until the end; `guide` holds what was taken. The glove is started and stopped. Blocks.
Result<SessionEnd> run_calibration_session(driver::Glove& glove, const std::string& user,
                                           const hand::FitOptions& fit, CalibrationGuide& guide);

} // namespace nendo::calibrate
