#pragma once
// Inverse kinematics: from places for the fingertips to joint angles, for pinches, for hands that
// touch a surface, and for key frames. A fingertip's place leaves one of a finger's four angles
// open; it is settled as a hand does it, near the angles from which it starts and with a finger's
// last two joints bending together.

#include <array>

#include <Eigen/Geometry>

#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joints.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// Each joint's range; radians. A range that is not finite, not ordered, or wider than a full turn
/// either way is replaced by the default one.
struct AngleLimits {
  JointAngles low;
  JointAngles high;
};

/// From end to end of joint_limits. Wait-free.
AngleLimits default_angle_limits() noexcept;

struct FingertipTarget {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  /// How much this tip counts beside the others when they pull at the wrist or the palm; 0 is no
  /// target at all, as is whatever is not finite, negative, or farther than farthest_m from 0.
  double weight = 0.0;

  static constexpr double farthest_m = 1e3;
};

/// Thumb to little finger.
using FingertipTargets = std::array<FingertipTarget, finger_count>;

/// Where the palm is to be, as another device tells it (OpenXR's palm pose).
struct PalmTarget {
  Eigen::Isometry3d T_world_palm = Eigen::Isometry3d::Identity();
  /// How much it counts beside the fingertips when the wrist is solved for both; 0 is no target at
  /// all, as is what is not finite or no rotation.
  double weight = 0.0;
};

struct InverseOptions {
  AngleLimits limits = default_angle_limits();
  bool solve_wrist = false;     ///< pitch and yaw, too; else they stay as they are at the start
  bool solve_palm_arch = false; ///< likewise
  /// Pitch and yaw are solved for it: alone, or together with the fingertips under solve_wrist.
  PalmTarget palm{};
  double tolerance_m = 1e-5; ///< how near counts as reached; 1e-9 at least
};

struct InverseSolution {
  JointAngles angles;
  /// From each target to the fingertip; 0 without a target.
  std::array<double, finger_count> residual_m{};
  /// From the palm to its target, by four points: its origin and, 0.1 m from it, one on each axis;
  /// root mean square. 0 without a target.
  double palm_off_m = 0.0;
  unsigned iterations = 0; ///< of all fingers together
  bool converged = false;  ///< every fingertip is within the tolerance of its target
};

/// Angles within the limits that bring each fingertip to its target. A target out of reach gets the
/// nearest place found from ten starts, the way from `start` itself preferred by 0.05 mm; so, too,
/// with palm and wrist solved, but begin near, for that has many more places to end.
/// Targets stand where T_world_wrist does: in the world, or, if that is the identity, in the frame
/// of the forearm's end. `start` is the previous pose, or the rest pose; what has no target keeps
/// its angles, clamped to the limits (what is not finite counts as zero). The same input gives the
/// same result. Wait-free, bounded time, no allocation; the result is finite.
InverseSolution inverse_kinematics(const HandSkeleton& skeleton,
                                   const Eigen::Isometry3d& T_world_wrist,
                                   const FingertipTargets& targets, const JointAngles& start,
                                   const InverseOptions& options = {}) noexcept;

} // namespace nendo::hand
