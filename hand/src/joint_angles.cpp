#include <nendo/hand/joint_angles.hpp>

#include <algorithm>

#include <nendo/hand/joint_limits.hpp>

namespace nendo::hand {
namespace {

// The rules of the header. The thumb's were chosen with this skeleton: of the ends from 20 to 90
// degrees of roll and 10 to 65 of abduction, these bring the tips together.
constexpr double thumb_ip_of_mcp = 0.5;
constexpr double pip_of_mcp = 1.1;
constexpr double resting_opposition = from_degrees(20);
constexpr double max_roll = from_degrees(30);
constexpr double max_abduction = from_degrees(35);
constexpr double fully_bent_thumb_mcp = from_degrees(55);

constexpr double bent(double angle_rad) noexcept {
  return std::max(angle_rad, 0.0);
}

constexpr double estimated_dip(double pip_rad) noexcept {
  return 0.32 * bent(pip_rad) * bent(pip_rad) + 0.17 * bent(pip_rad);
}

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
  double raw_angle(Sensor sensor) const noexcept { return angles_rad[index_of(sensor)]; }
  double angle(Sensor sensor, const JointLimit& limit) const noexcept {
    return limit.soften(raw_angle(sensor));
  }
  double angle_or(Sensor sensor, const JointLimit& limit, double estimate) const noexcept {
    return has(sensor) ? angle(sensor, limit) : limit.soften(estimate);
  }
};

FingerAngles finger_angles(const Measured& measured,
                           const std::array<Sensor, 3>& sensors) noexcept {
  const auto [mcp, pip, dip] = sensors;
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
  const double ring_little = measured.raw_angle(Sensor::ring_little_abduction);
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
  set(Angle::little_mcp_abduction, middle - middle_ring - ring_little);
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

const double& angle_in(const JointAngles& angles, Angle angle) noexcept {
  constexpr std::array<double JointAngles::*, 4> of_thumb{
      &JointAngles::thumb_roll_rad, &JointAngles::thumb_abduction_rad,
      &JointAngles::thumb_mcp_flexion_rad, &JointAngles::thumb_ip_flexion_rad};
  constexpr std::array<double FingerAngles::*, 4> of_finger{
      &FingerAngles::mcp_flexion_rad, &FingerAngles::mcp_abduction_rad,
      &FingerAngles::pip_flexion_rad, &FingerAngles::dip_flexion_rad};
  constexpr std::array<double JointAngles::*, 3> of_hand{
      &JointAngles::palm_arch_rad, &JointAngles::wrist_pitch_rad, &JointAngles::wrist_yaw_rad};
  const std::size_t at = index_of(angle);
  if (at < 4) return angles.*of_thumb[at];
  if (angle < Angle::palm_arch) return angles.fingers[at / 4 - 1].*of_finger[at % 4];
  return angles.*of_hand[at - index_of(Angle::palm_arch)];
}

constexpr std::size_t mcp_at = 0, pip_at = 1, dip_at = 2;

constexpr double resting_mcp = from_degrees(25), resting_pip = from_degrees(35);
constexpr double resting_thumb_mcp = from_degrees(15), resting_thumb_ip = from_degrees(20);
constexpr double opposed_at_rest = from_degrees(25);
constexpr double resting_gap = from_degrees(6), resting_arch = from_degrees(6);

/// A mean of estimates that are there.
class Mean {
public:
  void add(double value, double weight) noexcept {
    sum_ += weight * value;
    weight_ += weight;
  }
  double or_else(double otherwise) const noexcept {
    return weight_ > 0.0 ? sum_ / weight_ : otherwise;
  }

private:
  double sum_ = 0.0, weight_ = 0.0;
};

class Filling {
public:
  Filling(const GloveSample& sample, const Calibration& calibration, SensorMask left_out) noexcept
      : calibration_(calibration), measured_{sample.present.bits & ~left_out.bits},
        missing_{sample.present.bits & left_out.bits} {
    for (const Sensor sensor : measured_) {
      const std::size_t slot = index_of(sensor);
      angles_[slot] = calibration.sensors[slot].angle_rad(sample.raw[slot]);
    }
  }

  SensorAngles filled() noexcept {
    // MCP joints first: the others follow from them as well.
    for (std::size_t f = 0; f < finger_sensors.size(); ++f)
      fill(finger_sensors[f][mcp_at], [&] { return mcp(f); });
    for (std::size_t f = 0; f < finger_sensors.size(); ++f)
      fill(finger_sensors[f][pip_at], [&] { return pip(f); });
    for (std::size_t f = 0; f < finger_sensors.size(); ++f)
      fill(finger_sensors[f][dip_at], [&] { return dip(f); });
    fill_thumb();
    couple();
    fill_gaps();
    fill(Sensor::palm_arch, [] { return resting_arch; });
    // The wrist is straight: its angles stay 0.
    return angles_;
  }

private:
  double& at(Sensor sensor) noexcept { return angles_[index_of(sensor)]; }
  bool is_measured(Sensor sensor) const noexcept { return measured_.has(sensor); }
  template <class Estimate>
  void fill(Sensor sensor, Estimate&& estimate) noexcept {
    if (missing_.has(sensor)) at(sensor) = estimate();
  }
  /// Adds the same joint of the fingers beside this one, if measured.
  void add_beside(Mean& mean, std::size_t f, std::size_t joint, double weight) noexcept {
    for (const std::size_t beside : {f - 1, f + 1})
      if (beside < finger_sensors.size() && is_measured(finger_sensors[beside][joint]))
        mean.add(at(finger_sensors[beside][joint]), weight);
  }

  double mcp(std::size_t f) noexcept {
    Mean mean;
    add_beside(mean, f, mcp_at, 1.0);
    if (is_measured(finger_sensors[f][pip_at]))
      mean.add(bent(at(finger_sensors[f][pip_at])) / pip_of_mcp, 0.7);
    return mean.or_else(resting_mcp);
  }
  double pip(std::size_t f) noexcept {
    Mean mean;
    add_beside(mean, f, pip_at, 0.7);
    if (is_measured(finger_sensors[f][dip_at]))
      mean.add(1.5 * bent(at(finger_sensors[f][dip_at])), 2.0);
    if (is_measured(finger_sensors[f][mcp_at]))
      mean.add(pip_of_mcp * bent(at(finger_sensors[f][mcp_at])), 0.4);
    return mean.or_else(resting_pip);
  }
  double dip(std::size_t f) noexcept {
    Mean mean;
    add_beside(mean, f, dip_at, 0.7);
    mean.add(estimated_dip(at(finger_sensors[f][pip_at])), 1.0);
    return mean.or_else(0.0);
  }

  void fill_thumb() noexcept {
    const bool mcp = is_measured(Sensor::thumb_mcp), ip = is_measured(Sensor::thumb_ip);
    fill(Sensor::thumb_mcp,
         [&] { return ip ? 0.7 * bent(at(Sensor::thumb_ip)) : resting_thumb_mcp; });
    fill(Sensor::thumb_ip,
         [&] { return mcp ? 0.9 * bent(at(Sensor::thumb_mcp)) : resting_thumb_ip; });
  }
  /// As Calibration::angles_rad() does, with what the estimated joints do to the others. Of thumb
  /// roll and abduction, one that is left out is taken to be as at rest.
  void couple() noexcept {
    const SensorAngles lines = angles_;
    const auto line = [&](Sensor sensor) { return lines[index_of(sensor)]; };
    fill(Sensor::thumb_roll, [] { return opposed_at_rest; });
    fill(Sensor::thumb_abduction, [] { return opposed_at_rest; });
    for (std::size_t k = 0; k < couplings.size(); ++k) {
      const auto [of, by] = couplings[k];
      if (!is_measured(of)) continue;
      // The line of a coupled sensor is its angle without what is mixed into it.
      const double by_rad = missing_.has(by) && by == Sensor::thumb_roll
                                ? opposed_at_rest - calibration_.coupling_gains[0] * line(of)
                            : missing_.has(by) && by == Sensor::thumb_abduction
                                ? opposed_at_rest - calibration_.coupling_gains[1] * line(of)
                                : line(by);
      at(of) += calibration_.coupling_gains[k] * by_rad;
    }
  }
  void fill_gaps() noexcept {
    Mean mean;
    for (const Sensor gap : gap_sensors)
      if (is_measured(gap)) mean.add(at(gap), 1.0);
    for (const Sensor gap : gap_sensors)
      fill(gap, [&] { return mean.or_else(resting_gap); });
  }

  const Calibration& calibration_;
  SensorMask measured_, missing_;
  SensorAngles angles_{};
};

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
  for (std::size_t f = 0; f < finger_sensors.size(); ++f)
    angles.fingers[f] = finger_angles(measured, finger_sensors[f]);
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

SensorAngles filled_angles_rad(const GloveSample& sample, const Calibration& calibration,
                               SensorMask left_out) noexcept {
  if ((sample.present.bits & left_out.bits) == 0) return calibration.angles_rad(sample);
  return Filling(sample, calibration, left_out).filled();
}

} // namespace nendo::hand
