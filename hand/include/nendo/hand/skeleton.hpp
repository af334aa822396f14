#pragma once
// The paper's VR Hand: a skeleton of constant rest shape, and its forward kinematics. Numbers in,
// numbers out; every pose is computed from the rest shape and the current angles, so nothing drifts
// and a lost sample costs nothing.
//
// Frames follow OpenXR: right-handed; at zero angles a joint's -Z points to the fingertip, +Y out
// of the back of the hand, +X to the right. A pose sits at the base of the bone it is named after,
// tips at the end of the finger.

#include <array>

#include <Eigen/Geometry>

#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joints.hpp>

namespace nendo::hand {

/// The two external measures from which all bones are scaled. The defaults lie between the means of
/// women and men in the ANSUR II survey (2012).
struct HandSize {
  double length_m = 0.187;  ///< wrist crease to the tip of the middle finger
  double breadth_m = 0.083; ///< across the heads of the metacarpals
};

struct HandPose {
  std::array<Eigen::Isometry3d, joint_count> joints; ///< T_world_joint, by index_of(Joint); metres

  const Eigen::Isometry3d& operator[](Joint joint) const noexcept {
    return joints[index_of(joint)];
  }
  /// 3 by 5, thumb to little finger; metres.
  Eigen::Matrix<double, 3, 5> fingertip_positions() const noexcept;
};

class HandSkeleton {
public:
  explicit HandSkeleton(Side side, HandSize size = {});

  /// Forward kinematics. T_world_wrist is where the forearm ends; the wrist's own angles turn the
  /// hand about it. Wait-free, no allocation.
  HandPose pose(const JointAngles& angles, const Eigen::Isometry3d& T_world_wrist) const noexcept;

  Side side() const noexcept { return side_; }
  /// The bone that ends in `joint`, from its parent at zero angles, in the axes of a right hand's
  /// wrist; metres.
  const Eigen::Vector3d& rest_offset(Joint joint) const noexcept {
    return offsets_m_[index_of(joint)];
  }

private:
  HandPose right_hand_pose(const JointAngles& angles) const noexcept;

  Side side_;
  std::array<Eigen::Vector3d, joint_count> offsets_m_;
};

} // namespace nendo::hand
