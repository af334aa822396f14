#include <nendo/hand/joint_angles.hpp>

#include <algorithm>

#include <nendo/hand/joint_limits.hpp>

#include "finger_rules.hpp"

namespace nendo::hand {
namespace {

// The rules of the header. The thumb's were chosen with this skeleton: of the ends from 20 to 90
// degrees of roll and 10 to 65 of abduction, these bring the tips together.
constexpr double thumb_ip_of_mcp = 0.5;
constexpr double resting_opposition = from_degrees(20);
constexpr double max_roll = from_degrees(30);
constexpr double max_abduction = from_degrees(35);
constexpr double fully_bent_thumb_mcp = from_degrees(55);

/// The estimate of thumb roll or abduction, which reaches `max_rad`.
constexpr double estimated_opposition(double thumb_mcp_rad, double max_rad) noexcept {
  const double part = std::min(bent(thumb_mcp_rad) / fully_bent_thumb_mcp, 1.0);
  return resting_opposition + part * (max_rad - resting_opposition);
}

/// A sample seen through a calibration.
struct Measured {
  SensorMask present;
  SensorAngles angles_rad;

  bool has(Sensor sensor) const noexcept { return present.has(sensor); }
  /// The calibration's angle, without soft stops.
  double raw_angle(Sensor sensor) const noexcept { return angles_rad[index_of(sensor)]; }
  double angle(Sensor sensor, const JointLimit& limit) const noexcept {
    return limit.soften(raw_angle(sensor));
  }
  /// `estimate` where there is no such sensor.
  double angle_or(Sensor sensor, const JointLimit& limit, double estimate) const noexcept {
    return has(sensor) ? angle(sensor, limit) : limit.soften(estimate);
  }
};

FingerAngles finger_angles(const Measured& measured, Sensor mcp, Sensor pip, Sensor dip) noexcept {
  FingerAngles angles;
  const double mcp_guess =
      measured.has(pip) ? measured.angle(pip, finger_pip_limit) / pip_of_mcp : 0.0;
  angles.mcp_flexion_rad = measured.angle_or(mcp, finger_mcp_limit, mcp_guess);
  angles.pip_flexion_rad =
      measured.angle_or(pip, finger_pip_limit, pip_of_mcp * bent(angles.mcp_flexion_rad));
  angles.dip_flexion_rad =
      measured.angle_or(dip, finger_dip_limit, estimated_dip(angles.pip_flexion_rad));
  return angles;
}

// The sensors measure gaps. Away from the thumb is negative; what the middle finger turns by, turns
// all of them.
void set_abductions(JointAngles& angles, const Measured& measured, double middle_bias) noexcept {
  const double index_middle = measured.raw_angle(Sensor::index_middle_abduction);
  const double middle_ring = measured.raw_angle(Sensor::middle_ring_abduction);
  const double ring_pinky = measured.raw_angle(Sensor::ring_little_abduction);
  const double off_centre = index_middle - middle_ring;
  // Zero stays zero, whatever the other is: a broken gap must not turn all fingers.
  const bool straight = middle_bias == 0.0 || off_centre == 0.0;
  const double middle =
      straight ? 0.0 : limit_of(Angle::middle_mcp_abduction).soften(-middle_bias * off_centre);
  const auto set = [&](Angle angle, double angle_rad) {
    angles[angle] = limit_of(angle).soften(angle_rad);
  };
  angles[Angle::middle_mcp_abduction] = middle;
  set(Angle::index_mcp_abduction, middle + index_middle);
  set(Angle::ring_mcp_abduction, middle - middle_ring);
  set(Angle::little_mcp_abduction, middle - middle_ring - ring_pinky);
}

void set_thumb(JointAngles& angles, const Measured& measured) noexcept {
  const bool bends = measured.has(Sensor::thumb_mcp) || measured.has(Sensor::thumb_ip);
  const auto set = [&](Angle angle, Sensor sensor, double estimate) {
    angles[angle] = measured.angle_or(sensor, limit_of(angle), estimate);
  };
  const double mcp_guess =
      measured.has(Sensor::thumb_ip)
          ? measured.angle(Sensor::thumb_ip, limit_of(Angle::thumb_ip_flexion)) / thumb_ip_of_mcp
          : 0.0;
  set(Angle::thumb_mcp_flexion, Sensor::thumb_mcp, mcp_guess);
  const double mcp = angles.thumb_mcp_flexion_rad;
  const auto opposition = [&](double max_rad) {
    return bends ? estimated_opposition(mcp, max_rad) : 0.0;
  };
  set(Angle::thumb_roll, Sensor::thumb_roll, opposition(max_roll));
  set(Angle::thumb_abduction, Sensor::thumb_abduction, opposition(max_abduction));
  set(Angle::thumb_ip_flexion, Sensor::thumb_ip, thumb_ip_of_mcp * bent(mcp));
}

// The member that is named.
const double& angle_in(const JointAngles& angles, Angle angle) noexcept {
  switch (angle) {
  case Angle::thumb_roll:
    return angles.thumb_roll_rad;
  case Angle::thumb_abduction:
    return angles.thumb_abduction_rad;
  case Angle::thumb_mcp_flexion:
    return angles.thumb_mcp_flexion_rad;
  case Angle::thumb_ip_flexion:
    return angles.thumb_ip_flexion_rad;
  case Angle::palm_arch:
    return angles.palm_arch_rad;
  case Angle::wrist_pitch:
    return angles.wrist_pitch_rad;
  case Angle::wrist_yaw:
    return angles.wrist_yaw_rad;
  default:
    break;
  }
  constexpr std::array<double FingerAngles::*, 4> of_finger{
      &FingerAngles::mcp_flexion_rad, &FingerAngles::mcp_abduction_rad,
      &FingerAngles::pip_flexion_rad, &FingerAngles::dip_flexion_rad};
  const std::size_t at = index_of(angle) - index_of(Angle::index_mcp_flexion);
  return angles.fingers[at / 4].*of_finger[at % 4];
}

} // namespace

const double& JointAngles::operator[](Angle angle) const noexcept {
  return angle_in(*this, angle);
}

double& JointAngles::operator[](Angle angle) noexcept {
  return const_cast<double&>(angle_in(*this, angle)); // *this is not const
}

JointAngles joint_angles(const GloveSample& sample, const Calibration& calibration,
                         SensorMask left_out) noexcept {
  const Measured measured{sample.present, filled_angles_rad(sample, calibration, left_out)};
  JointAngles angles;
  set_thumb(angles, measured);
  angles[Finger::index] =
      finger_angles(measured, Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip);
  angles[Finger::middle] =
      finger_angles(measured, Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip);
  angles[Finger::ring] =
      finger_angles(measured, Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip);
  angles[Finger::little] =
      finger_angles(measured, Sensor::little_mcp, Sensor::little_pip, Sensor::little_dip);
  set_abductions(angles, measured, calibration.middle_bias);
  const auto set_or_zero = [&](Angle angle, Sensor sensor) {
    angles[angle] = measured.angle_or(sensor, limit_of(angle), 0.0);
  };
  set_or_zero(Angle::palm_arch, Sensor::palm_arch);
  set_or_zero(Angle::wrist_pitch, Sensor::wrist_pitch);
  set_or_zero(Angle::wrist_yaw, Sensor::wrist_yaw);
  return angles;
}

SensorAngles sensor_angles_of(const JointAngles& joints) noexcept {
  SensorAngles angles{};
  const auto at = [&](Sensor sensor) -> double& { return angles[index_of(sensor)]; };
  at(Sensor::thumb_roll) = joints.thumb_roll_rad;
  at(Sensor::thumb_mcp) = joints.thumb_mcp_flexion_rad;
  at(Sensor::thumb_ip) = joints.thumb_ip_flexion_rad;
  at(Sensor::thumb_abduction) = joints.thumb_abduction_rad;
  for (std::size_t f = 0; f < joints.fingers.size(); ++f) {
    const auto [mcp, pip, dip] = finger_sensors[f];
    at(mcp) = joints.fingers[f].mcp_flexion_rad;
    at(pip) = joints.fingers[f].pip_flexion_rad;
    at(dip) = joints.fingers[f].dip_flexion_rad;
    if (f > 0) // the gap's slot is after the DIP joint's
      angles[index_of(dip) + 1] =
          joints.fingers[f - 1].mcp_abduction_rad - joints.fingers[f].mcp_abduction_rad;
  }
  at(Sensor::palm_arch) = joints.palm_arch_rad;
  at(Sensor::wrist_pitch) = joints.wrist_pitch_rad;
  at(Sensor::wrist_yaw) = joints.wrist_yaw_rad;
  return angles;
}

} // namespace nendo::hand
