#include <nendo/hand/angle_sources.hpp>

namespace nendo::hand {
namespace {

struct FingerSensors {
  Sensor mcp;
  Sensor pip;
  Sensor dip;
};
constexpr std::array<FingerSensors, 4> finger_sensors{{
    {Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip},
    {Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip},
    {Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip},
    {Sensor::pinky_mcp, Sensor::pinky_pip, Sensor::pinky_dip},
}};

/// Measured if there is such a sensor.
AngleSource measured_or(SensorMask present, Sensor sensor, AngleSource otherwise) noexcept {
  return present.has(sensor) ? AngleSource::measured : otherwise;
}

} // namespace

AngleSources angle_sources(SensorMask present) noexcept {
  AngleSources sources;
  sources.fill(AngleSource::zero);
  const auto source = [&](Angle angle) -> AngleSource& { return sources[index_of(angle)]; };
  const auto take = [&](Angle angle, Sensor sensor, AngleSource otherwise) {
    source(angle) = measured_or(present, sensor, otherwise);
  };
  constexpr auto zero = AngleSource::zero;

  const bool thumb_bends = present.has(Sensor::thumb_mcp) || present.has(Sensor::thumb_ip);
  const auto opposition = thumb_bends ? AngleSource::opposition : zero;
  take(Angle::thumb_roll, Sensor::thumb_roll, opposition);
  take(Angle::thumb_abduction, Sensor::thumb_abduction, opposition);
  take(Angle::thumb_mcp_flexion, Sensor::thumb_mcp, thumb_bends ? AngleSource::from_ip : zero);
  take(Angle::thumb_ip_flexion, Sensor::thumb_ip, thumb_bends ? AngleSource::from_mcp : zero);

  for (std::size_t f = 0; f < finger_sensors.size(); ++f) {
    const auto [mcp, pip, dip] = finger_sensors[f];
    const auto of_finger = [&](Angle index_s) { return angle_at(index_of(index_s) + 4 * f); };
    const bool bends = present.has(mcp) || present.has(pip);
    take(of_finger(Angle::index_mcp_flexion), mcp, bends ? AngleSource::from_pip : zero);
    take(of_finger(Angle::index_pip_flexion), pip, bends ? AngleSource::from_mcp : zero);
    take(of_finger(Angle::index_dip_flexion), dip, bends ? AngleSource::from_pip : zero);
  }

  // No sensor measures the middle finger's own direction: a calibration's middle bias may turn it,
  // and all others with it, by the two gaps beside it. The little finger needs two gaps.
  const bool index_middle = present.has(Sensor::index_middle_abduction);
  const bool middle_ring = present.has(Sensor::middle_ring_abduction);
  const bool ring_pinky = present.has(Sensor::ring_pinky_abduction);
  const auto of_middle = index_middle || middle_ring ? AngleSource::from_gaps : zero;
  source(Angle::middle_mcp_abduction) = of_middle;
  take(Angle::index_mcp_abduction, Sensor::index_middle_abduction, of_middle);
  take(Angle::ring_mcp_abduction, Sensor::middle_ring_abduction, of_middle);
  const auto of_little = ring_pinky ? AngleSource::from_gaps : of_middle;
  source(Angle::little_mcp_abduction) =
      middle_ring && ring_pinky ? AngleSource::measured : of_little;

  take(Angle::palm_arch, Sensor::palm_arch, zero);
  take(Angle::wrist_pitch, Sensor::wrist_pitch, zero);
  take(Angle::wrist_yaw, Sensor::wrist_yaw, zero);
  return sources;
}

} // namespace nendo::hand
