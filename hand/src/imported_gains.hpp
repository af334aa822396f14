#pragma once
// From lines of some other program's to a calibration: signs, and sensors that must be there.

#include <array>
#include <cstddef>
#include <string_view>

#include <nendo/hand/calibration_exchange.hpp>

namespace nendo::hand {

/// Lines as they were read, in counts of 0 to 255.
struct ReadLines {
  std::array<SensorCalibration, sensor_slots> sensors{};
  std::array<std::size_t, sensor_slots> line{}; ///< where in the text; 0: nowhere
};

/// Turns what is written in the other frame (calibration_exchange.hpp) and judges every line. What
/// every CyberGlove has must be calibrated, if `complete`. Error: bad_input.
Result<ImportedCalibration> imported(ReadLines lines, std::string_view name, bool complete);

} // namespace nendo::hand
