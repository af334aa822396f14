#include "bench/plain_hand.hpp"

#include <cmath>

namespace nendo::bench {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using hand::Joint;

enum Axis : Eigen::Index { x_axis, y_axis, z_axis };

Matrix4d turn(Axis axis, double angle_rad) {
  const Eigen::Index a = (axis + 1) % 3;
  const Eigen::Index b = (axis + 2) % 3;
  Matrix4d m = Matrix4d::Identity();
  m(a, a) = m(b, b) = std::cos(angle_rad);
  m(b, a) = std::sin(angle_rad);
  m(a, b) = -m(b, a);
  return m;
}

Matrix4d move(const Vector3d& by_m) {
  Matrix4d m = Matrix4d::Identity();
  m.topRightCorner<3, 1>() = by_m;
  return m;
}

/// From -Z to the bone's direction, by the shortest way.
Matrix4d along(const Vector3d& bone_m) {
  Matrix4d m = Matrix4d::Identity();
  m.topLeftCorner<3, 3>() =
      Eigen::Quaterniond::FromTwoVectors(-Vector3d::UnitZ(), bone_m).toRotationMatrix();
  return m;
}

constexpr double arch_share[4] = {0.0, 0.0, 0.5, 1.0};
constexpr Joint metacarpals[4] = {Joint::index_metacarpal, Joint::middle_metacarpal,
                                  Joint::ring_metacarpal, Joint::little_metacarpal};

} // namespace

PlainPose plain_pose(const hand::HandSkeleton& skeleton, const hand::JointAngles& angles,
                     const Eigen::Isometry3d& T_world_wrist) noexcept {
  PlainPose pose;
  const auto at = [&](Joint joint) -> Matrix4d& { return pose[hand::index_of(joint)]; };
  const auto bone = [&](Joint joint) { return move(skeleton.rest_offset(joint)); };
  const Matrix4d wrist = turn(y_axis, angles.wrist_yaw_rad) * turn(x_axis, -angles.wrist_pitch_rad);
  at(Joint::wrist) = wrist;
  at(Joint::palm) = wrist * bone(Joint::palm) * along(skeleton.rest_offset(Joint::middle_proximal));
  at(Joint::thumb_metacarpal) =
      wrist * bone(Joint::thumb_metacarpal) * turn(z_axis, angles.thumb_roll_rad) *
      turn(y_axis, from_degrees(15) + angles.thumb_abduction_rad) *
      turn(z_axis,
           from_degrees(47) - 0.41 * angles.thumb_roll_rad - 0.27 * angles.thumb_abduction_rad);
  at(Joint::thumb_proximal) = at(Joint::thumb_metacarpal) * bone(Joint::thumb_proximal) *
                              turn(x_axis, -angles.thumb_mcp_flexion_rad);
  at(Joint::thumb_distal) = at(Joint::thumb_proximal) * bone(Joint::thumb_distal) *
                            turn(x_axis, -angles.thumb_ip_flexion_rad);
  at(Joint::thumb_tip) = at(Joint::thumb_distal) * bone(Joint::thumb_tip);
  for (std::size_t f = 0; f < 4; ++f) {
    const auto j = [&](std::size_t n) {
      return static_cast<Joint>(hand::index_of(metacarpals[f]) + n);
    };
    const hand::FingerAngles& finger = angles.fingers[f];
    const Matrix4d root = wrist * bone(j(0)) * turn(x_axis, -arch_share[f] * angles.palm_arch_rad);
    at(j(0)) = root * along(skeleton.rest_offset(j(1)));
    at(j(1)) = root * bone(j(1)) * turn(y_axis, finger.mcp_abduction_rad) *
               turn(x_axis, -finger.mcp_flexion_rad);
    at(j(2)) = at(j(1)) * bone(j(2)) * turn(x_axis, -finger.pip_flexion_rad);
    at(j(3)) = at(j(2)) * bone(j(3)) * turn(x_axis, -finger.dip_flexion_rad);
    at(j(4)) = at(j(3)) * bone(j(4));
  }
  const Matrix4d mirror = Eigen::Vector4d(-1.0, 1.0, 1.0, 1.0).asDiagonal();
  for (Matrix4d& joint : pose) {
    if (skeleton.side() == Side::left) joint = (mirror * joint * mirror).eval();
    joint = (T_world_wrist.matrix() * joint).eval();
  }
  return pose;
}

} // namespace nendo::bench
