#pragma once
// The picture of nendo calibrate in a terminal: what to do, a drawing of the pose from two sides,
// and the present counts of the sensors.

#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/hand/skeleton.hpp>

#include "calibrate/guide.hpp"
#include "cli/terminal.hpp"
#include "gloves/monitor_screen.hpp"

namespace nendo::calibrate {

/// The contents of a picture. Everything that is pointed to must outlive the picture.
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
