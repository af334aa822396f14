#include <nendo/hand/angle_sources.hpp>

#include <algorithm>
#include <cmath>

#include <nendo/base/units.hpp>

namespace nendo::hand {
namespace {

void set_left_out(AngleSources& sources, SensorMask present, SensorMask left_out) noexcept {
  const SensorMask measured{present.bits & ~left_out.bits};
  const auto is_out = [&](Sensor sensor) { return present.has(sensor) && left_out.has(sensor); };
  const auto set = [&](Angle angle, Sensor sensor, AngleSource source) {
    if (is_out(sensor)) sources[index_of(angle)] = source;
  };
  for (std::size_t f = 0; f < finger_sensors.size(); ++f) {
    const auto [mcp, pip, dip] = finger_sensors[f];
    const auto of_finger = [&](Angle index_s) { return angle_at(index_of(index_s) + 4 * f); };
    set(of_finger(Angle::index_mcp_flexion), mcp, AngleSource::from_neighbours);
    set(of_finger(Angle::index_pip_flexion), pip, AngleSource::from_neighbours);
    set(of_finger(Angle::index_dip_flexion), dip, AngleSource::from_neighbours);
  }
  const auto by_thumb = [&](Sensor other, AngleSource source) {
    return measured.has(other) ? source : AngleSource::at_rest;
  };
  set(Angle::thumb_mcp_flexion, Sensor::thumb_mcp,
      by_thumb(Sensor::thumb_ip, AngleSource::from_ip));
  set(Angle::thumb_ip_flexion, Sensor::thumb_ip,
      by_thumb(Sensor::thumb_mcp, AngleSource::from_mcp));
  set(Angle::thumb_roll, Sensor::thumb_roll, AngleSource::at_rest);
  set(Angle::thumb_abduction, Sensor::thumb_abduction, AngleSource::at_rest);
  const bool any_gap = (measured.bits & mask_of(gap_sensors).bits) != 0;
  const auto by_gaps = any_gap ? AngleSource::from_gaps : AngleSource::at_rest;
  set(Angle::index_mcp_abduction, Sensor::index_middle_abduction, by_gaps);
  set(Angle::ring_mcp_abduction, Sensor::middle_ring_abduction, by_gaps);
  set(Angle::little_mcp_abduction, Sensor::middle_ring_abduction, by_gaps);
  set(Angle::little_mcp_abduction, Sensor::ring_little_abduction, by_gaps);
  set(Angle::palm_arch, Sensor::palm_arch, AngleSource::at_rest);
  set(Angle::wrist_pitch, Sensor::wrist_pitch, AngleSource::at_rest);
  set(Angle::wrist_yaw, Sensor::wrist_yaw, AngleSource::at_rest);
}

// Measured, degrees: roll, abduction, MCP and IP of the thumb; MCP flexion, MCP abduction, PIP and
// DIP of a finger; the palm's arch, which was not judged; the wrist.
constexpr std::array<double, 4> thumb_deg{4.5, 5.0, 2.8, 2.8};
constexpr std::array<double, 4> finger_deg{2.6, 1.8, 2.8, 2.2};
constexpr double arch_deg = 4.0;
constexpr double wrist_deg = 2.7;

/// The deviation of a DIP joint that is estimated from a PIP joint at this angle.
double dip_deg(double pip_rad) noexcept {
  if (!std::isfinite(pip_rad)) return 90.0;
  const double pip_deg = std::clamp(to_degrees(pip_rad), -30.0, 130.0);
  return 16.0 + 0.65 * std::max(0.0, 38.0 - pip_deg) + 0.6 * std::max(0.0, pip_deg - 65.0);
}

double measured_deg(std::size_t at) noexcept {
  if (at < 4) return thumb_deg[at];
  if (at < index_of(Angle::palm_arch)) return finger_deg[at % 4];
  return at == index_of(Angle::palm_arch) ? arch_deg : wrist_deg;
}

double estimated_deg(AngleSource source, const JointAngles& angles, std::size_t at) noexcept {
  switch (source) {
  case AngleSource::from_pip: // of a finger's DIP, or of its MCP
    return at % 4 == 3 ? dip_deg(angles[angle_at(at - 1)]) : 20.0;
  case AngleSource::from_gaps:
    return 6.0;
  case AngleSource::opposition:
    return 15.0;
  case AngleSource::from_neighbours: // of a finger's MCP, PIP or DIP
    return at % 4 == 0 ? 18.0 : 15.0;
  default:
    return 20.0;
  }
}

} // namespace

AngleSources angle_sources(SensorMask present, SensorMask left_out) noexcept {
  AngleSources sources;
  sources.fill(AngleSource::zero);
  const auto source = [&](Angle angle) -> AngleSource& { return sources[index_of(angle)]; };
  const auto take = [&](Angle angle, Sensor sensor, AngleSource otherwise) {
    source(angle) = present.has(sensor) ? AngleSource::measured : otherwise;
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
  const bool ring_little = present.has(Sensor::ring_little_abduction);
  const auto of_middle = index_middle || middle_ring ? AngleSource::from_gaps : zero;
  source(Angle::middle_mcp_abduction) = of_middle;
  take(Angle::index_mcp_abduction, Sensor::index_middle_abduction, of_middle);
  take(Angle::ring_mcp_abduction, Sensor::middle_ring_abduction, of_middle);
  const auto of_little = ring_little ? AngleSource::from_gaps : of_middle;
  source(Angle::little_mcp_abduction) =
      middle_ring && ring_little ? AngleSource::measured : of_little;

  take(Angle::palm_arch, Sensor::palm_arch, zero);
  take(Angle::wrist_pitch, Sensor::wrist_pitch, zero);
  take(Angle::wrist_yaw, Sensor::wrist_yaw, zero);
  set_left_out(sources, present, left_out);
  return sources;
}

AngleDeviations angle_deviations(const JointAngles& angles, SensorMask present,
                                 SensorMask left_out) noexcept {
  const AngleSources sources = angle_sources(present, left_out);
  AngleDeviations deviations{};
  for (std::size_t at = 0; at < angle_count; ++at) {
    if (sources[at] == AngleSource::zero) continue;
    deviations[at] = from_degrees(is_estimated(sources[at]) ? estimated_deg(sources[at], angles, at)
                                                            : measured_deg(at));
  }
  return deviations;
}

} // namespace nendo::hand
