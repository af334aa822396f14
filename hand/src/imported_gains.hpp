#pragma once
// Makes a calibration of the lines that another program wrote: corrects signs, and checks that
// required sensors are there.

#include <array>
#include <cstddef>
#include <string_view>

#include <nendo/hand/calibration_exchange.hpp>

namespace nendo::hand {

/// Lines as they were read, in counts of 0 to 255.
struct ReadLines {
  std::array<SensorCalibration, sensor_slots> sensors{};
  std::array<std::size_t, sensor_slots> line{}; ///< its line number in the text; 0: none
  /// Signs of gaps between fingers are kept as they are: the text says for certain that spreading
  /// is positive.
  bool gaps_may_fall = false;
};

/// Inverts the signs of gains in the other frame (calibration_exchange.hpp) and checks
/// every line. If `complete`, the sensors that every CyberGlove has must be calibrated. Error:
/// bad_input.
Result<ImportedCalibration> imported(ReadLines lines, std::string_view name, bool complete);

} // namespace nendo::hand
