#pragma once
// Checks what a calibration may contain, for readers and writers alike. Each complaint_about
// function returns a complaint that names no place, or an empty string if nothing is wrong.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/hand/calibration_exchange.hpp>
#include <nendo/hand/calibration_file.hpp>

namespace nendo::hand {

/// No calibration file of any format may be larger.
inline constexpr std::uint64_t max_calibration_bytes = std::uint64_t{1} << 20;

std::string complaint_about_text(std::string_view text, bool may_be_empty);
/// Checks a calibrated sensor's line: here a gain of 0 is an error.
std::string complaint_about(Sensor sensor, const SensorCalibration& line, CountScale counts);
std::string complaint_about(const SensorQuality& quality);
std::string complaint_about(const HandSize& size);
std::string complaint_about_coupling(double rad_per_rad);
std::string complaint_about_bias(double middle_bias);
/// Checks everything; a sensor of gain 0 is left out.
std::string complaint_about(const WearerCalibration& wearer);

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
