#pragma once
// Forward kinematics as in a textbook: the product of a homogeneous matrix for each rotation and
// each bone. nendo::hand is compared with it in speed and result.

#include <array>

#include <nendo/hand/skeleton.hpp>

namespace nendo::bench {

/// The T_world_joint of every joint, by index_of(Joint).
using PlainPose = std::array<Eigen::Matrix4d, hand::joint_count>;

PlainPose plain_pose(const hand::HandSkeleton& skeleton, const hand::JointAngles& angles,
                     const Eigen::Isometry3d& T_world_wrist) noexcept;

} // namespace nendo::bench
