#pragma once
// What a calibration may hold, for readers and writers alike. Each function gives a complaint
// without a place, or an empty string.

#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/hand/calibration_file.hpp>

namespace nendo::hand {

/// No calibration file of any form may be larger.
inline constexpr std::uint64_t most_calibration_bytes = std::uint64_t{1} << 20;

/// Counts rise with the joint's angle in every glove that has this sensor: it bends, or lies
/// between two fingers. The wrist's, the arch's and the thumb's other sensors have signs that
/// depend on how a glove is sewn.
bool rises_with_angle(Sensor sensor) noexcept;
/// Slot 23 has a place in the protocol, but no glove fills it.
bool may_be_calibrated(Sensor sensor) noexcept;

std::string complaint_about_text(std::string_view text, bool may_be_empty);
std::string complaint_about_gain(Sensor sensor, double gain_rad_per_count, CountScale counts);
std::string complaint_about_offset(double offset_counts);
/// `gain` is not 0 here.
std::string complaint_about(Sensor sensor, const SensorCalibration& line, CountScale counts);
std::string complaint_about(const SensorQuality& quality);
std::string complaint_about(const HandSize& size);
std::string complaint_about_mixing(double rad_per_rad);
std::string complaint_about_bias(double middle_bias);
/// Of the whole, in which a sensor of gain 0 is left out.
std::string complaint_about(const WearerCalibration& wearer);

} // namespace nendo::hand
