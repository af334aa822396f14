#include <nendo/hand/angle_deviations.hpp>

#include <algorithm>
#include <cmath>

#include <nendo/base/units.hpp>

namespace nendo::hand {
namespace {

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
