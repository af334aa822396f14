#pragma once
// Reports the result of a calibration: as a table for people, and as a picture.

#include <filesystem>
#include <ostream>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/calibration_fit.hpp>

namespace nendo::calibrate {

/// Prints a line for each sensor: its range, its gain, how far the poses are from its line, how
/// sure its angles are, and what was kept of the default; and one for each sensor that was
/// `left_out`, because it is stuck. Then prints the poses that agree least,
/// and the condition.
void print_report(std::ostream& out, const hand::CalibrationFit& fit,
                  std::span<const hand::PoseReading> readings, SensorMask sensors,
                  SensorMask left_out = {});

/// Writes an SVG picture that shows whose calibration it is and when it was made, and for each
/// sensor the ranges of counts and of angles, and the residual. Blocks. Error: failed.
Result<void> write_report_picture(const std::filesystem::path& path,
                                  const hand::CalibrationFit& fit,
                                  const hand::WearerCalibration& wearer, SensorMask sensors);

} // namespace nendo::calibrate
