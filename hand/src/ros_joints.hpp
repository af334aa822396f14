#pragma once
// What the two forms in which ROS drivers keep CyberGlove calibrations have in common: joints by
// name, and for each its points of a piecewise linear curve.

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/hand/calibration_exchange.hpp>

namespace nendo::hand {

/// A sensor's raw value, 0 to 1 for counts of 1 to 255, and the joint's angle there.
struct RosPoint {
  double raw = 0.0;
  double angle_deg = 0.0;
};

struct RosJoint {
  std::string name;
  std::size_t line = 0; ///< in the text
  std::vector<RosPoint> points;
};

/// The names by slot; empty for slots that no glove has.
inline constexpr std::array<std::string_view, sensor_slots> ros_names{
    "G_ThumbRotate", "G_ThumbMPJ",   "G_ThumbIJ",   "G_ThumbAb",
    "G_IndexMPJ",    "G_IndexPIJ",   "G_IndexDIJ",  "",
    "G_MiddleMPJ",   "G_MiddlePIJ",  "G_MiddleDIJ", "G_MiddleIndexAb",
    "G_RingMPJ",     "G_RingPIJ",    "G_RingDIJ",   "G_RingMiddleAb",
    "G_PinkieMPJ",   "G_PinkiePIJ",  "G_PinkieDIJ", "G_PinkieRingAb",
    "G_PalmArch",    "G_WristPitch", "G_WristYaw",  "",
};

/// The first count is 1, and the last one is 255: a glove never sends 0.
inline constexpr double ros_first_count = 1.0;
inline constexpr double ros_counts = 254.0;

struct BestLine {
  double slope = 0.0;
  double at_zero = 0.0;   ///< its value at 0
  double deviation = 0.0; ///< the greatest, as it is at `deviation_at`
  double deviation_at = 0.0;
};
/// Returns the line that has the least greatest deviation from the points, and that deviation.
/// `points` are sorted by `raw`, with two different ones at least.
BestLine best_line(const std::vector<RosPoint>& points);

/// Makes a calibration of the joints. Notes name the joints that are not known or not there, those
/// whose line measures nothing and is left out, and those that bend off their line. Error:
/// bad_input.
Result<ImportedCalibration> imported_joints(std::vector<RosJoint> joints, std::string_view name);

} // namespace nendo::hand
