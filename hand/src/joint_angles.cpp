#include <nendo/hand/joint_angles.hpp>

#include <algorithm>
#include <numbers>

namespace nendo::hand {
namespace {

constexpr double degrees(double d) noexcept {
  return d * std::numbers::pi / 180.0;
}

struct Range {
  double low_rad;
  double high_rad;
  constexpr double clamp(double angle_rad) const noexcept {
    // Written so that a NaN from a broken calibration becomes the lower end.
    return angle_rad > low_rad ? std::min(angle_rad, high_rad) : low_rad;
  }
};

// Ranges of motion as clinical goniometry gives them (American Academy of Orthopaedic Surgeons:
// finger MCP 0-90 and 20-30 of extension, PIP 0-100, DIP 0-80, thumb MCP 0-55, IP 0-80, wrist
// 70-80), a little widened, because a glove that reads past them is more often badly calibrated
// than worn by an acrobat.
constexpr Range mcp_flexion{degrees(-30), degrees(100)};
constexpr Range pip_flexion{degrees(-10), degrees(115)};
constexpr Range dip_flexion{degrees(-10), degrees(85)};
constexpr Range pair_abduction{degrees(-10), degrees(40)};
constexpr Range thumb_roll{degrees(-20), degrees(90)};
constexpr Range thumb_abduction{degrees(-10), degrees(70)};
constexpr Range thumb_mcp{degrees(-20), degrees(70)};
constexpr Range thumb_ip{degrees(-20), degrees(90)};
constexpr Range palm_arch{degrees(-5), degrees(35)};
constexpr Range wrist_pitch{degrees(-75), degrees(85)};
constexpr Range wrist_yaw{degrees(-40), degrees(30)};

constexpr double estimated_dip(double pip_rad) noexcept {
  return pip_rad > 0.0 ? 0.32 * pip_rad * pip_rad + 0.17 * pip_rad : 0.0;
}

} // namespace

JointAngles joint_angles(const GloveSample& sample, const Calibration& calibration) noexcept {
  const auto measured = [&](Sensor sensor, Range range) {
    return sample.present.has(sensor) ? range.clamp(calibration[sensor].angle_rad(sample[sensor]))
                                      : 0.0;
  };
  const auto finger = [&](Sensor mcp, Sensor pip, Sensor dip, double abduction_rad) {
    FingerAngles angles;
    angles.mcp_flexion_rad = measured(mcp, mcp_flexion);
    angles.mcp_abduction_rad = abduction_rad;
    angles.pip_flexion_rad = measured(pip, pip_flexion);
    angles.dip_flexion_rad = sample.present.has(dip)
                                 ? measured(dip, dip_flexion)
                                 : dip_flexion.clamp(estimated_dip(angles.pip_flexion_rad));
    return angles;
  };
  const double index_middle = measured(Sensor::index_middle_abduction, pair_abduction);
  const double middle_ring = measured(Sensor::middle_ring_abduction, pair_abduction);
  const double ring_pinky = measured(Sensor::ring_pinky_abduction, pair_abduction);

  JointAngles angles;
  angles.thumb_roll_rad = measured(Sensor::thumb_roll, thumb_roll);
  angles.thumb_abduction_rad = measured(Sensor::thumb_abduction, thumb_abduction);
  angles.thumb_mcp_flexion_rad = measured(Sensor::thumb_mcp, thumb_mcp);
  angles.thumb_ip_flexion_rad = measured(Sensor::thumb_ip, thumb_ip);
  angles[Finger::index] =
      finger(Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip, index_middle);
  angles[Finger::middle] = finger(Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip, 0.0);
  angles[Finger::ring] = finger(Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip, -middle_ring);
  angles[Finger::little] =
      finger(Sensor::pinky_mcp, Sensor::pinky_pip, Sensor::pinky_dip, -(middle_ring + ring_pinky));
  angles.palm_arch_rad = measured(Sensor::palm_arch, palm_arch);
  angles.wrist_pitch_rad = measured(Sensor::wrist_pitch, wrist_pitch);
  angles.wrist_yaw_rad = measured(Sensor::wrist_yaw, wrist_yaw);
  return angles;
}

} // namespace nendo::hand
