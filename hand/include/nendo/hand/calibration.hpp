#pragma once
// Calibration: from raw counts to sensor angles, one line a sensor: angle = gain * (raw - offset).
// This is the vendor's own form (VirtualHand SDK, vhtCyberGlove). Flexion and spreading are
// positive.

#include <array>

#include <nendo/driver/sample.hpp>

namespace nendo::hand {

struct SensorCalibration {
  double gain_rad_per_count = 0.0;
  double offset_counts = 0.0;

  constexpr double angle_rad(RawCount raw) const noexcept {
    return gain_rad_per_count * (static_cast<double>(raw.value) - offset_counts);
  }
};

struct Calibration {
  std::array<SensorCalibration, sensor_slots> sensors{};

  constexpr const SensorCalibration& operator[](Sensor sensor) const noexcept {
    return sensors[static_cast<std::size_t>(sensor)];
  }
};

/// Usable for an average hand without any file; a wearer's own calibration is better. The same for
/// both sides. A whole-range scale is spread over each joint's range of motion, from straight
/// (closed) at 0 to fully bent (spread) at `most`; the wrist, which turns both ways, from one end
/// to the other. Counts of a bare converter are taken for a CyberGlove's, and its typical 8-bit
/// values scaled to `most`. With `most` = 0 every gain is 0.
Calibration default_calibration(CountScale scale = {}) noexcept;

} // namespace nendo::hand
