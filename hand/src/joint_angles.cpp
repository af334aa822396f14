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

// The rules of the header. The thumb's were chosen with this skeleton: of the ends from 50 to 70
// degrees, and ratios of 0.3 to 1, these bring the tips together.
constexpr double pip_of_mcp = 1.1;
constexpr double thumb_ip_of_mcp = 0.5;
constexpr double resting_opposition = degrees(20);
constexpr double full_opposition = degrees(60);
constexpr double fully_bent_thumb_mcp = degrees(55);

constexpr double bent(double angle_rad) noexcept {
  return std::max(angle_rad, 0.0);
}

constexpr double estimated_dip(double pip_rad) noexcept {
  return 0.32 * bent(pip_rad) * bent(pip_rad) + 0.17 * bent(pip_rad);
}

constexpr double estimated_opposition(double thumb_mcp_rad) noexcept {
  const double part = std::min(bent(thumb_mcp_rad) / fully_bent_thumb_mcp, 1.0);
  return resting_opposition + part * (full_opposition - resting_opposition);
}

/// A sample seen through a calibration.
struct Measured {
  SensorMask present;
  SensorAngles angles_rad;

  bool has(Sensor sensor) const noexcept { return present.has(sensor); }
  double angle(Sensor sensor, Range range) const noexcept {
    return range.clamp(angles_rad[static_cast<std::size_t>(sensor)]);
  }
  /// `estimate` where there is no such sensor.
  double angle_or(Sensor sensor, Range range, double estimate) const noexcept {
    return has(sensor) ? angle(sensor, range) : range.clamp(estimate);
  }
};

FingerAngles finger_angles(const Measured& measured, Sensor mcp, Sensor pip, Sensor dip,
                           double abduction_rad) noexcept {
  FingerAngles angles;
  const double mcp_guess = measured.has(pip) ? measured.angle(pip, pip_flexion) / pip_of_mcp : 0.0;
  angles.mcp_flexion_rad = measured.angle_or(mcp, mcp_flexion, mcp_guess);
  angles.mcp_abduction_rad = abduction_rad;
  angles.pip_flexion_rad =
      measured.angle_or(pip, pip_flexion, pip_of_mcp * bent(angles.mcp_flexion_rad));
  angles.dip_flexion_rad =
      measured.angle_or(dip, dip_flexion, estimated_dip(angles.pip_flexion_rad));
  return angles;
}

void set_thumb(JointAngles& angles, const Measured& measured) noexcept {
  const bool bends = measured.has(Sensor::thumb_mcp) || measured.has(Sensor::thumb_ip);
  const double mcp_guess = measured.has(Sensor::thumb_ip)
                               ? measured.angle(Sensor::thumb_ip, thumb_ip) / thumb_ip_of_mcp
                               : 0.0;
  const double mcp = measured.angle_or(Sensor::thumb_mcp, thumb_mcp, mcp_guess);
  const double opposition = bends ? estimated_opposition(mcp) : 0.0;
  angles.thumb_roll_rad = measured.angle_or(Sensor::thumb_roll, thumb_roll, opposition);
  angles.thumb_abduction_rad =
      measured.angle_or(Sensor::thumb_abduction, thumb_abduction, opposition);
  angles.thumb_mcp_flexion_rad = mcp;
  angles.thumb_ip_flexion_rad =
      measured.angle_or(Sensor::thumb_ip, thumb_ip, thumb_ip_of_mcp * bent(mcp));
}

} // namespace

JointAngles joint_angles(const GloveSample& sample, const Calibration& calibration) noexcept {
  const Measured measured{sample.present, calibration.angles_rad(sample)};
  const auto or_zero = [&](Sensor sensor, Range range) {
    return measured.angle_or(sensor, range, 0.0);
  };
  const double index_middle = or_zero(Sensor::index_middle_abduction, pair_abduction);
  const double middle_ring = or_zero(Sensor::middle_ring_abduction, pair_abduction);
  const double ring_pinky = or_zero(Sensor::ring_pinky_abduction, pair_abduction);
  // Away from the thumb is negative; what the middle finger turns by, turns all of them.
  const double middle = -calibration.middle_bias * (index_middle - middle_ring);

  JointAngles angles;
  set_thumb(angles, measured);
  angles[Finger::index] = finger_angles(measured, Sensor::index_mcp, Sensor::index_pip,
                                        Sensor::index_dip, middle + index_middle);
  angles[Finger::middle] =
      finger_angles(measured, Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip, middle);
  angles[Finger::ring] = finger_angles(measured, Sensor::ring_mcp, Sensor::ring_pip,
                                       Sensor::ring_dip, middle - middle_ring);
  angles[Finger::little] = finger_angles(measured, Sensor::pinky_mcp, Sensor::pinky_pip,
                                         Sensor::pinky_dip, middle - middle_ring - ring_pinky);
  angles.palm_arch_rad = or_zero(Sensor::palm_arch, palm_arch);
  angles.wrist_pitch_rad = or_zero(Sensor::wrist_pitch, wrist_pitch);
  angles.wrist_yaw_rad = or_zero(Sensor::wrist_yaw, wrist_yaw);
  return angles;
}

} // namespace nendo::hand
