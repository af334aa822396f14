#pragma once
// What a calibration came to: a table for people, and a picture.

#include <filesystem>
#include <ostream>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration_fit.hpp>

namespace nendo::calibrate {

/// A line for each sensor: range, gain, how far the poses are from it, how sure its angles are, and
/// what was kept of the default; then the poses that agree least, and the condition.
void print_report(std::ostream& out, const hand::CalibrationFit& fit,
                  std::span<const hand::PoseReading> readings, SensorMask sensors);

/// The same as an SVG picture: by sensor the range of counts and of angles, and the residual.
/// Error: failed.
Result<void> write_report_picture(const std::filesystem::path& path,
                                  const hand::CalibrationFit& fit, SensorMask sensors,
                                  CountScale counts);

} // namespace nendo::calibrate
