#pragma once
// Calibration converts raw counts to joint angles. Each sensor has its own line in the vendor's
// form, angle = gain * (raw - offset) (VirtualHand SDK, vhtCyberGlove). Couplings are added to the
// lines and correct cross-talk: the thumb sensors mix roll and abduction, and the flexion of two
// neighbouring fingers also stretches the abduction sensor between them. Flexion and spreading are
// positive.

#include <array>

#include <nendo/driver/sample.hpp>

namespace nendo::hand {

/// The angle of each sensor's joint, by slot; radians.
using SensorAngles = std::array<double, sensor_slots>;

struct SensorCalibration {
  double gain_rad_per_count = 0.0;
  double offset_counts = 0.0;

  constexpr double angle_rad(RawCount raw) const noexcept {
    return gain_rad_per_count * (static_cast<double>(raw.value) - offset_counts);
  }
  friend constexpr bool operator==(const SensorCalibration&, const SensorCalibration&) = default;
};

struct Coupling {
  Sensor of;
  Sensor by;
};
inline constexpr std::array<Coupling, 8> couplings{{
    {Sensor::thumb_roll, Sensor::thumb_abduction},
    {Sensor::thumb_abduction, Sensor::thumb_roll},
    {Sensor::index_middle_abduction, Sensor::index_mcp},
    {Sensor::index_middle_abduction, Sensor::middle_mcp},
    {Sensor::middle_ring_abduction, Sensor::middle_mcp},
    {Sensor::middle_ring_abduction, Sensor::ring_mcp},
    {Sensor::ring_little_abduction, Sensor::ring_mcp},
    {Sensor::ring_little_abduction, Sensor::little_mcp},
}};

struct NENDO_API Calibration {
  std::array<SensorCalibration, sensor_slots> sensors{};
  /// One factor per entry of `couplings`: radians added to sensor `of` per radian of the line of
  /// sensor `by`.
  std::array<double, couplings.size()> coupling_gains{};
  /// The middle finger's abduction, which no sensor measures, is -middle_bias * (index-middle gap -
  /// middle-ring gap); 0 keeps the finger straight. The term is the vendor's.
  double middle_bias = 0.0;

  constexpr const SensorCalibration& operator[](Sensor sensor) const noexcept {
    return sensors[index_of(sensor)];
  }
  constexpr SensorCalibration& operator[](Sensor sensor) noexcept {
    return sensors[index_of(sensor)];
  }

  constexpr bool has_couplings() const noexcept {
    return coupling_gains != decltype(coupling_gains){};
  }
  /// Returns the joint angle of every present sensor, and 0 for the others, which also add nothing
  /// by couplings. Wait-free.
  SensorAngles angles_rad(const GloveSample& sample) const noexcept;
  friend constexpr bool operator==(const Calibration&, const Calibration&) = default;
};

/// Returns a calibration for an average hand, the same for both sides; a wearer's own calibration
/// is better. A self-calibrated scale is mapped to each joint's range of motion: from straight
/// (closed) at 0 to fully bent (spread) at `max_count`, and for the wrist, which turns both ways,
/// from one end to the other. For other scales, a CyberGlove's typical 8-bit values are scaled to
/// `max_count`. With `max_count` = 0 every gain is 0.
NENDO_API Calibration default_calibration(CountScale scale = {}) noexcept;

} // namespace nendo::hand
