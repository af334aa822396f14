#pragma once
// The picture of nendo calibrate in a terminal: what to do, a drawing of the pose from two sides,
// and the sensors as they move.

#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/hand/skeleton.hpp>

#include "calibrate/guide.hpp"
#include "cli/terminal.hpp"
#include "gloves/monitor_screen.hpp"

namespace nendo::calibrate {

/// What a picture is made of. Everything that is pointed to lives as long as the picture.
struct CalibrationPicture {
  const driver::GloveInfo* info = nullptr;
  const std::string* user = nullptr;
  const CalibrationGuide* guide = nullptr;       ///< not done
  const GloveSample* sample = nullptr;           ///< the latest; null: none came yet
  const gloves::SeenCounts* seen = nullptr;      ///< has seen `sample`
  double age_s = 0.0;                            ///< of `sample`
  const hand::HandPose* demonstration = nullptr; ///< of the pose that the guide asks for
  bool begun = false;                            ///< else the guide sees no samples yet
  SensorMask undetermined;                       ///< by the poses so far
};

/// Lines of printable ASCII, at most as many and as long as the screen. The drawing and then the
/// bars go where the screen is small; the instruction and the keys stay.
std::vector<std::string> calibration_lines(const CalibrationPicture& picture, cli::ScreenSize size);

/// The pose as a wearer would take it. Touching tips are brought together, by inverse kinematics:
/// too much for every picture.
hand::HandPose demonstrated(hand::PoseId pose, Side side);

} // namespace nendo::calibrate
