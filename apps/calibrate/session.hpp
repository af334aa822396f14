#pragma once
// A guided calibration at a terminal: shows the poses, reads the glove, and follows the keys.

#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/hand/skeleton.hpp>

#include "calibrate/guide.hpp"
#include "cli/terminal.hpp"
#include "gloves/monitor_screen.hpp"

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

/// What the terminal shows: what to do, a drawing of the pose from two sides, and the counts of the
/// sensors. Everything that is pointed to must outlive the picture.
struct CalibrationPicture {
  const driver::GloveInfo* info = nullptr;
  const std::string* user = nullptr;
  const CalibrationGuide* guide = nullptr;       ///< must not be done
  const GloveSample* sample = nullptr;           ///< the latest; null: none came yet
  const gloves::SeenCounts* seen = nullptr;      ///< includes `sample`
  double age_s = 0.0;                            ///< age of `sample`
  const hand::HandPose* demonstration = nullptr; ///< the pose that the guide asks for
  bool begun = false;                            ///< false: the guide sees no samples yet
  SensorMask undetermined;                       ///< sensors that the poses so far leave open
  std::string notice{};                          ///< what the wearer must know; empty: nothing
};

/// Returns lines of printable ASCII, at most as many and as long as the screen. What is longer than
/// the screen is broad continues in the next line, but for the title. On a small screen first the
/// drawing is left out and then the bars; the instruction and the keys stay.
std::vector<std::string> calibration_lines(const CalibrationPicture& picture, cli::ScreenSize size);

} // namespace nendo::calibrate
