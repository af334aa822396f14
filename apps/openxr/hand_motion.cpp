#include "openxr/hand_motion.hpp"

#include <algorithm>
#include <cstddef>

#include <nendo/hand/joints.hpp>

namespace nendo::openxr {
namespace {

constexpr std::size_t wrist = hand::index_of(hand::Joint::wrist);

/// Returns the rotation vector, in radians, that turns `from` into `to` by the shorter way.
Eigen::Vector3d turn(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) noexcept {
  Eigen::Quaterniond turned = to * from.conjugate();
  if (turned.w() < 0.0) turned.coeffs() = -turned.coeffs();
  const Eigen::AngleAxisd angle(turned);
  return angle.angle() * angle.axis();
}

Eigen::Quaterniond turned_by(const Eigen::Vector3d& turn_rad,
                             const Eigen::Quaterniond& from) noexcept {
  const double angle = turn_rad.norm();
  if (angle == 0.0) return from;
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn_rad / angle)) * from;
}

void extrapolate(MovingHand& hand, const HandPose& newest, double after_s) noexcept {
  for (std::size_t k = 0; k < joint_count; ++k)
    hand.joints[k].orientation =
        turned_by(hand.angular_rad_per_s[k] * after_s, newest[k].orientation);
  hand.joints[wrist].position = newest[wrist].position + hand.linear_m_per_s[wrist] * after_s;
  for (std::size_t k = 0; k < joint_count; ++k) {
    const auto above = hand::parent_of(static_cast<hand::Joint>(k));
    if (!above) continue;
    const std::size_t parent = hand::index_of(*above); // it precedes the joint, or is the wrist
    const Eigen::Vector3d bone =
        newest[parent].orientation.conjugate() * (newest[k].position - newest[parent].position);
    hand.joints[k].position = hand.joints[parent].position + hand.joints[parent].orientation * bone;
  }
}

} // namespace

MovingHand at_time(const PublishedHand& hand, std::int64_t time_ns) noexcept {
  MovingHand moving;
  moving.joints = hand.newest;
  moving.has_velocity = hand.has_earlier && !hand.is_silent;
  if (!moving.has_velocity) return moving;
  const double between_s = static_cast<double>(hand.newest_ns - hand.earlier_ns) / 1e9;
  for (std::size_t k = 0; k < joint_count; ++k) {
    moving.linear_m_per_s[k] = (hand.newest[k].position - hand.earlier[k].position) / between_s;
    moving.angular_rad_per_s[k] =
        turn(hand.earlier[k].orientation, hand.newest[k].orientation) / between_s;
  }
  // By way of floating-point numbers, in which no difference of times overflows.
  constexpr double max_ns = static_cast<double>(max_extrapolation_ns);
  const double after_ns = std::clamp(
      static_cast<double>(time_ns) - static_cast<double>(hand.newest_ns), -max_ns, max_ns);
  if (after_ns != 0.0) extrapolate(moving, hand.newest, after_ns / 1e9);
  return moving;
}

} // namespace nendo::openxr
