#include "fingertip.hpp"

#include <cmath>

#include "turns.hpp"

namespace nendo::hand {
namespace {

/// Where a bone, or a row of them, leads in the plane in which a finger bends: so far ahead, so far
/// towards the palm. Turned by a right angle it is the derivative by the angle at its root.
struct Reach {
  double ahead_m = 0.0;
  double down_m = 0.0;
  friend Reach operator+(Reach a, Reach b) noexcept {
    return {a.ahead_m + b.ahead_m, a.down_m + b.down_m};
  }
  Reach by_flexion() const noexcept { return {-down_m, ahead_m}; }
};

Reach bone(double length_m, Turn flexion) noexcept {
  return {length_m * flexion.cos, length_m * flexion.sin};
}

Eigen::Vector3d turned_about_x(const Eigen::Vector3d& v, Turn turn) noexcept {
  return {v.x(), turn.cos * v.y() - turn.sin * v.z(), turn.sin * v.y() + turn.cos * v.z()};
}

} // namespace

FingerChain::FingerChain(const HandSkeleton& skeleton, std::size_t finger) noexcept
    : is_thumb_(finger == 0), arch_share_(finger == 0 ? 0.0 : arch_share[finger - 1]),
      base_m_(skeleton.rest_offset(metacarpals[finger])), head_m_(Eigen::Vector3d::Zero()),
      thumb_axes_(skeleton.axes().thumb), thumb_rest_rad_(skeleton.axes().thumb_rest_rad),
      pronation_(skeleton.axes().thumb_pronation), tilt_(0.0, 1.0) {
  if (!is_thumb_) {
    const double tilt_rad = skeleton.axes().knuckle_tilts_rad[finger - 1];
    tilt_ = {std::sin(tilt_rad), std::cos(tilt_rad)};
  }
  std::size_t joint = index_of(metacarpals[finger]) + 1;
  if (!is_thumb_) head_m_ = skeleton.rest_offset(static_cast<Joint>(joint++));
  for (double& bone_m : bones_m_)
    bone_m = -skeleton.rest_offset(static_cast<Joint>(joint++)).z();
}

// Seen from the last joint, the pad is as a shorter bone's end that is bent a little.
FingerChain FingerChain::to_pad(const HandSkeleton& skeleton, std::size_t finger) noexcept {
  FingerChain chain(skeleton, finger);
  const double depth_m = -skeleton.pad().y(), ahead_m = chain.bones_m_[2] - skeleton.pad().z();
  chain.last_turn_rad_ = std::atan2(depth_m, ahead_m);
  chain.bones_m_[2] = std::hypot(depth_m, ahead_m);
  return chain;
}

Fingertip FingerChain::finger_tip(const FourAngles& angles) const noexcept {
  const double mcp = angles[0];
  const double pip = mcp + angles[2];
  const auto t = turns(Eigen::Array4d(angles[1], mcp, pip, pip + angles[3]));
  const Turn abduction = t[0];
  const Reach distal = bone(bones_m_[2], t[3]);
  const Reach from_pip = bone(bones_m_[1], t[2]) + distal;
  const Reach from_mcp = bone(bones_m_[0], t[1]) + from_pip;
  const auto in_space = [&](Reach reach) {
    const double aside_m = reach.down_m * tilt_[0];
    return Eigen::Vector3d(abduction.cos * aside_m - abduction.sin * reach.ahead_m,
                           -reach.down_m * tilt_[1],
                           -abduction.sin * aside_m - abduction.cos * reach.ahead_m);
  };
  Fingertip tip;
  tip.position_m = in_space(from_mcp);
  tip.by_angle << in_space(from_mcp.by_flexion()),
      Eigen::Vector3d(tip.position_m.z(), 0.0, -tip.position_m.x()),
      in_space(from_pip.by_flexion()), in_space(distal.by_flexion());
  return tip;
}

Fingertip FingerChain::thumb_tip(const FourAngles& angles) const noexcept {
  Eigen::Array<double, 6, 1> row;
  row << angles[0], thumb_rest_rad_ + angles[1], pronation_.at(angles[0], angles[1]), angles[2],
      angles[2] + angles[3], 0.0;
  const auto t = turns(row);
  const Turn roll = t[0];
  const Turn abduction = t[1];
  const Turn pronation = t[2];
  const Reach distal = bone(bones_m_[2], t[4]);
  const Reach from_mcp = bone(bones_m_[1], t[3]) + distal;
  const auto rolled = [&](double x, double y, double z) {
    return Eigen::Vector3d(roll.cos * x - roll.sin * y, roll.sin * x + roll.cos * y, z);
  };
  const auto abducted = [&](double x, double y, double z) {
    return rolled(abduction.cos * x + abduction.sin * z, y, abduction.cos * z - abduction.sin * x);
  };
  const auto in_space = [&](Reach reach) {
    return abducted(reach.down_m * pronation.sin, -reach.down_m * pronation.cos, -reach.ahead_m);
  };
  Fingertip tip;
  tip.position_m = in_space(Reach{bones_m_[0], 0.0} + from_mcp);
  const Eigen::Vector3d& p = tip.position_m;
  const double before_roll_x = roll.cos * p.x() + roll.sin * p.y();
  const Eigen::Vector3d by_pronation =
      abducted(from_mcp.down_m * pronation.cos, from_mcp.down_m * pronation.sin, 0.0);
  tip.by_angle << Eigen::Vector3d(-p.y(), p.x(), 0.0) + pronation_.by_roll * by_pronation,
      rolled(p.z(), 0.0, -before_roll_x) + pronation_.by_abduction * by_pronation,
      in_space(from_mcp.by_flexion()), in_space(distal.by_flexion());
  tip.position_m = thumb_axes_ * tip.position_m;
  tip.by_angle = thumb_axes_ * tip.by_angle;
  return tip;
}

Fingertip FingerChain::tip(const FourAngles& own_angles, double palm_arch_rad) const noexcept {
  FourAngles angles = own_angles;
  angles[3] += last_turn_rad_;
  Fingertip tip = is_thumb_ ? thumb_tip(angles) : finger_tip(angles);
  tip.position_m += head_m_;
  if (moves_with_arch()) {
    const double angle_rad = -arch_share_ * palm_arch_rad;
    const Turn arch{std::sin(angle_rad), std::cos(angle_rad)};
    tip.position_m = turned_about_x(tip.position_m, arch);
    for (Eigen::Index k = 0; k < 4; ++k)
      tip.by_angle.col(k) = turned_about_x(tip.by_angle.col(k), arch);
  }
  tip.position_m += base_m_;
  return tip;
}

Eigen::Vector3d FingerChain::by_arch(const Eigen::Vector3d& tip_m) const noexcept {
  return -arch_share_ * Eigen::Vector3d::UnitX().cross(tip_m - base_m_);
}

} // namespace nendo::hand
