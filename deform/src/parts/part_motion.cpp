#include "parts/part_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nendo::deform {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

bool stays(const HeldFrame& hand) noexcept {
  return hand.now.matrix() == hand.from.matrix();
}

/// By which angle a rotation turns about an axis, the rest being turns of the axis itself.
double angle_about(const Vector3d& axis, const Quaterniond& turn) noexcept {
  return 2.0 * std::atan2(turn.vec().dot(axis), turn.w());
}

Quaterniond turn_of(const HeldFrame& hand) noexcept {
  return Quaterniond(hand.now.linear() * hand.from.linear().transpose()).normalized();
}

/// Within half a turn.
double near_zero(double angle) noexcept {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

Quaterniond turn_of_two(const HeldFrame& one, const HeldFrame& other) noexcept {
  const Vector3d before = other.from.translation() - one.from.translation();
  const Vector3d after = other.now.translation() - one.now.translation();
  const Quaterniond first = turn_of(one), second = turn_of(other);
  if (!(before.norm() > 0.0) || !(after.norm() > 0.0)) return first.slerp(0.5, second);
  const Vector3d axis = after.normalized();
  const Quaterniond along = Quaterniond::FromTwoVectors(before, after);
  const double of_first = near_zero(angle_about(axis, first * along.conjugate()));
  const double of_second = near_zero(angle_about(axis, second * along.conjugate()));
  // From the one to the other on the shorter way.
  const double mean = of_first + 0.5 * near_zero(of_second - of_first);
  return Quaterniond(Eigen::AngleAxisd(mean, axis)) * along;
}

} // namespace

Isometry3d motion_of(std::span<const HeldFrame> hands) noexcept {
  if (std::all_of(hands.begin(), hands.end(), stays)) return Isometry3d::Identity();
  if (hands.size() == 1) return hands[0].now * hands[0].from.inverse();
  const Vector3d from = 0.5 * (hands[0].from.translation() + hands[1].from.translation());
  const Vector3d now = 0.5 * (hands[0].now.translation() + hands[1].now.translation());
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = turn_of_two(hands[0], hands[1]).toRotationMatrix();
  motion.translation() = now - motion.linear() * from;
  return motion;
}

} // namespace nendo::deform
