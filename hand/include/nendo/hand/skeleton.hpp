#pragma once
// The paper's VR Hand: a skeleton of constant rest shape, and its forward kinematics. Every pose is
// computed from the rest shape and the current angles alone, so errors do not accumulate, even if
// samples are lost.
//
// Frames follow OpenXR: right-handed; at zero angles a joint's -Z points to the fingertip, +Y out
// of the back of the hand, +X to the right. A joint's pose is at the base of the bone that it is
// named after, a tip's pose at the end of the finger.

#include <array>

#include <Eigen/Geometry>

#include <nendo/base/side.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joints.hpp>
#include <nendo/hand/wearer_shape.hpp>

namespace nendo::hand {

/// The two external measures from which all bones are scaled, and the deviations from an average
/// hand of these measures. The defaults lie between the means of women and men in the ANSUR II
/// survey (2012).
struct HandSize {
  double length_m = 0.187;  ///< wrist crease to the tip of the middle finger
  double breadth_m = 0.083; ///< across the heads of the metacarpals
  WearerShape shape{};
};

struct NENDO_API HandPose {
  std::array<Eigen::Isometry3d, joint_count> joints; ///< T_world_joint, by index_of(Joint); metres

  const Eigen::Isometry3d& operator[](Joint joint) const noexcept {
    return joints[index_of(joint)];
  }
  /// Returns the positions of the fingertips, 3 by 5, thumb to little finger; metres.
  Eigen::Matrix<double, 3, 5> fingertip_positions() const noexcept;
};

/// The rotation of the thumb about its long axis. At 90 degrees it flexes across the palm.
struct ThumbPronation {
  double at_zero_rad;           ///< at zero angles
  double by_roll, by_abduction; ///< its change per radian
  double at(double roll_rad, double abduction_rad) const noexcept {
    return at_zero_rad + by_roll * roll_rad + by_abduction * abduction_rad;
  }
};

class NENDO_API HandSkeleton {
public:
  explicit HandSkeleton(Side side, const HandSize& size = {});

  /// Returns the pose by forward kinematics. T_world_wrist is the pose of the forearm's end; the
  /// wrist's angles rotate the hand about it. An angle that is not finite counts as zero.
  /// Wait-free, no allocation.
  HandPose pose(const JointAngles& angles, const Eigen::Isometry3d& T_world_wrist) const noexcept;

  /// The axes of the thumb and of the knuckles, in the axes of a right hand.
  struct Axes {
    Eigen::Matrix3d thumb; ///< the thumb's rolling axes, in the wrist's axes
    bool thumb_is_tilted;  ///< false: `thumb` is the identity
    double thumb_rest_rad; ///< the angle between thumb and index finger at zero angles
    ThumbPronation thumb_pronation;
    std::array<double, 4> knuckle_tilts_rad; ///< rotations of the fingers about their long axes
  };
  const Axes& axes() const noexcept { return axes_; }
  /// Returns the centre of a digit's pad, in the frame of its tip; metres.
  const Eigen::Vector3d& pad() const noexcept { return pad_m_; }

  Side side() const noexcept { return side_; }
  /// Returns the vector from the parent of `joint` to `joint` at zero angles, in the axes of a
  /// right hand's wrist; metres.
  const Eigen::Vector3d& rest_offset(Joint joint) const noexcept {
    return offsets_m_[index_of(joint)];
  }

private:
  using Offsets = std::array<Eigen::Vector3d, joint_count>;
  /// The constants of a finger's kinematics, in the axes of this side's own hand.
  struct FingerRoot {
    Eigen::Vector3d base_m; ///< the metacarpal's base, from the wrist
    Eigen::Vector3d head_m; ///< the metacarpal's head, from its base
    /// The axes of the metacarpal. Its -Z points along the bone, whereas the finger's zero is
    /// parallel to the wrist's axis.
    Eigen::Matrix3d metacarpal_axes;
    Eigen::Vector2d tilt; ///< the sine and cosine of the knuckle's tilt
  };

  struct Walk;

  static Offsets offsets_of(const HandSize& size);

  Side side_;
  Offsets offsets_m_;
  Axes axes_;
  Eigen::Matrix3d own_thumb_axes_; ///< axes of this side's own hand
  Eigen::Vector3d pad_m_;
  Eigen::Vector3d palm_m_;
  Eigen::Vector3d thumb_base_m_;
  std::array<FingerRoot, 4> fingers_;
};

} // namespace nendo::hand
