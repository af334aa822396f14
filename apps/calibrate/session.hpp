#pragma once
// A guided calibration at a terminal: shows the poses, reads the glove, and follows the keys.

#include <string>

#include <nendo/driver/glove.hpp>

#include "calibrate/guide.hpp"

namespace nendo::calibrate {

enum class SessionEnd : std::uint8_t {
  complete, ///< every pose was taken or skipped, and a calibration fits them
  written,  ///< the wearer asked to write the poses taken so far, and a calibration fits them
  quit,     ///< ended by a key, a signal, or because the terminal is gone
};

/// Runs the calibration until one of these ends; `guide` then holds what was taken. If no
/// calibration fits the poses, the picture says why, and the session continues: with the last pose
/// once more if all were taken. Starts the glove and stops it. Blocks.
Result<SessionEnd> run_calibration_session(driver::Glove& glove, const std::string& user,
                                           const hand::FitOptions& fit, CalibrationGuide& guide);

} // namespace nendo::calibrate
