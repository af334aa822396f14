#include "motions/kneading_hand.hpp"

#include <cmath>

#include <nendo/hand/inverse_kinematics.hpp>

#include "motions/touch_score.hpp"

namespace nendo::motions {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using hand::JointAngles;

namespace {

constexpr double up_rad = from_degrees(50.0); // of the fingers: both tips reach then

} // namespace

double ease(double time_s, double begin_s, double end_s) noexcept {
  return min_jerk((time_s - begin_s) / (end_s - begin_s));
}

Matrix3d axes_of(const Vector3d& fingers, const Vector3d& back) noexcept {
  Matrix3d axes;
  axes.col(2) = -fingers.normalized();
  axes.col(1) = (back - back.dot(axes.col(2)) * axes.col(2)).normalized();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return axes;
}

JointAngles flat_hand() noexcept {
  JointAngles angles;
  angles.thumb_abduction_rad = from_degrees(10);
  return angles;
}

JointAngles fist() noexcept {
  JointAngles angles;
  for (auto& finger : angles.fingers)
    finger = {from_degrees(85), 0.0, from_degrees(100), from_degrees(60)};
  return angles;
}

JointAngles blended(const JointAngles& from, const JointAngles& to, double part) noexcept {
  JointAngles angles;
  for (std::size_t k = 0; k < hand::angle_count; ++k) {
    const hand::Angle angle = hand::angle_at(k);
    angles[angle] = from[angle] + part * (to[angle] - from[angle]);
  }
  return angles;
}

PinchingFingers::PinchingFingers(const hand::HandSkeleton& skeleton, double open_gap_m,
                                 double closed_gap_m) {
  JointAngles start;
  for (auto& finger : start.fingers)
    finger = {1.2, 0.0, 1.4, 0.9};
  start.fingers[0] = {0.6, 0.0, 0.5, 0.3};
  start.thumb_roll_rad = 0.6;
  start.thumb_abduction_rad = 0.5;
  stage_ = Eigen::AngleAxisd(from_degrees(30.0), Vector3d::UnitZ()).matrix() *
           Eigen::AngleAxisd(from_degrees(-70.0), Vector3d::UnitX()).matrix();
  if (skeleton.side() == Side::left) stage_.row(0) *= -1.0;
  open_ = pinched(skeleton, start, open_gap_m);
  closed_ = pinched(skeleton, start, closed_gap_m);
}

KneadPlan::Pose PinchingFingers::at(const Vector3d& tips, double closed) const noexcept {
  return {blended(open_, closed_, closed), wrist_at(tips)};
}

Isometry3d PinchingFingers::wrist_at(const Vector3d& tips) const noexcept {
  Isometry3d wrist = Isometry3d::Identity();
  wrist.linear() = axes_of(stage_ * Vector3d(-std::cos(up_rad), std::sin(up_rad), 0.0),
                           stage_ * Vector3d(std::sin(up_rad), std::cos(up_rad), 0.0));
  wrist.translation() = tips + stage_ * Vector3d(0.130, -0.030, -0.020);
  return wrist;
}

JointAngles PinchingFingers::pinched(const hand::HandSkeleton& skeleton, const JointAngles& start,
                                     double gap_m) const {
  hand::FingertipTargets targets;
  targets[0] = {-0.5 * gap_m * stage_.col(1), 1.0};
  targets[1] = {0.5 * gap_m * stage_.col(1), 1.0};
  return hand::inverse_kinematics(skeleton, wrist_at(Vector3d::Zero()), targets, start).angles;
}

} // namespace nendo::motions
