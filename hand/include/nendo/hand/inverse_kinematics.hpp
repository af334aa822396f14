#pragma once
// Inverse kinematics: finds joint angles that bring the fingertips to target positions, for
// pinches, for hands that touch a surface, and for key frames. A fingertip's position leaves one of
// a finger's four angles undetermined. It is chosen as in a natural hand: near the start angles,
// with PIP and DIP bending together.

#include <array>

#include <Eigen/Geometry>

#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joints.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// Each joint's range, in radians. A range that is not finite, not ordered, or beyond a full turn
/// either way is replaced by the default range.
struct AngleLimits {
  JointAngles low;
  JointAngles high;
};

/// Returns the full ranges of joint_limits. Wait-free.
NENDO_API AngleLimits default_angle_limits() noexcept;

struct FingertipTarget {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  /// The weight of this tip relative to the others if the wrist or palm is solved. A zero, negative
  /// or non-finite weight disables the target, and so does a position that is not finite or farther
  /// than farthest_m from the origin.
  double weight = 0.0;

  static constexpr double farthest_m = 1e3;
};

using FingertipTargets = std::array<FingertipTarget, finger_count>;

struct InverseOptions {
  AngleLimits limits = default_angle_limits();
  bool solve_wrist = false;     ///< solves pitch and yaw; else they stay as in `start`
  bool solve_palm_arch = false; ///< solves the arch; else it stays as in `start`
  double tolerance_m = 1e-5;    ///< distance that counts as reached; at least 1e-9
};

struct InverseSolution {
  JointAngles angles;
  /// The distance from each target to its fingertip; 0 without a target.
  std::array<double, finger_count> residual_m{};
  bool converged = false; ///< every fingertip is within the tolerance of its target
};

/// Returns angles within the limits that bring each fingertip to its target. For a target out of
/// reach, the tip is at the nearest position found from ten starts; the result from `start` itself
/// is preferred unless another is nearer by 0.05 mm. The same holds if palm and wrist are solved,
/// but `start` must then be near the solution, because there are many more local minima. Targets
/// are in world coordinates, as T_world_wrist is, or, if this is the identity, in the frame of the
/// forearm's end. `start` is the previous pose or the rest pose. Fingers without a target keep
/// their angles, clamped to the limits (an angle that is not finite counts as zero). Deterministic,
/// wait-free, bounded time, no allocation; the result is finite.
NENDO_API InverseSolution inverse_kinematics(const HandSkeleton& skeleton,
                                             const Eigen::Isometry3d& T_world_wrist,
                                             const FingertipTargets& targets,
                                             const JointAngles& start,
                                             const InverseOptions& options = {}) noexcept;

} // namespace nendo::hand
