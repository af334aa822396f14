#pragma once
// What a wearer should know about a finished calibration: how sure each joint is, and what to do
// about those that are not.

#include <cstdint>
#include <string>
#include <vector>

#include <nendo/base/units.hpp>

#include "calibrate/wearer_file.hpp"

namespace nendo::calibrate {

/// How well the angles of a joint are known.
enum class Certainty : std::uint8_t {
  sure,
  less_sure, ///< the poses determine them, but by more than `sure_to_rad`
  average,   ///< partly those of an average hand
  estimated, ///< the sensor is stuck, and its neighbours give them
};
inline constexpr double sure_to_rad = from_degrees(6.0);

Certainty certainty_of(const FinishedCalibration& finished, Sensor sensor) noexcept;

struct Finding {
  std::string text;   ///< what is not sure
  std::string remedy; ///< what to do about it
};
/// Returns what is not sure, the most serious first; empty if all is.
std::vector<Finding> findings(const FinishedCalibration& finished, CalibrationKind kind);
/// Returns the number of the reading that most needs to be taken again.
std::size_t worst_reading(const FinishedCalibration& finished) noexcept;
/// Returns the median of the sensors' residuals.
double typical_residual_rad(const FinishedCalibration& finished);

/// Returns the pose's name in words: "pinch ring".
std::string title_of(hand::PoseId pose);

} // namespace nendo::calibrate
