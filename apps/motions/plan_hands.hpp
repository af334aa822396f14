#pragma once
// Common parts of the plans of kneading hands.

#include <Eigen/Geometry>

#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

#include "motions/knead_plan.hpp"

namespace nendo::motions {

inline constexpr double away_m = 0.05;       ///< from the model, where a motion begins and ends
inline constexpr double pinch_gap_m = 0.011; ///< between the tips of thumb and index finger

/// From 0 at `begin_s` to 1 at `end_s`.
double ease(double time_s, double begin_s, double end_s) noexcept;
/// Returns a wrist's axes, with the fingers along `fingers` and the back of the hand towards
/// `back`.
Eigen::Matrix3d axes_of(const Eigen::Vector3d& fingers, const Eigen::Vector3d& back) noexcept;
hand::JointAngles flat_hand() noexcept;
/// Bent fingers that are out of the way of a thumb or of a pinch.
hand::JointAngles fist() noexcept;

/// Interpolates between two hands' angles: 0 is `from`, and 1 is `to`.
hand::JointAngles blended(const hand::JointAngles& from, const hand::JointAngles& to,
                          double part) noexcept;

/// Thumb and index finger at a side of the model, from above.
class PinchingFingers {
public:
  /// `open_gap_m` and `closed_gap_m` are between the tips.
  PinchingFingers(const hand::HandSkeleton& skeleton, double open_gap_m, double closed_gap_m);

  Eigen::Vector3d outwards() const noexcept { return stage_.col(0); }
  /// With the middle between the tips there, and fingers that are closed by so much, 0 to 1.
  KneadPlan::Pose at(const Eigen::Vector3d& tips, double closed) const noexcept;

private:
  Eigen::Isometry3d wrist_at(const Eigen::Vector3d& tips) const noexcept;
  hand::JointAngles pinched(const hand::HandSkeleton& skeleton, const hand::JointAngles& start,
                            double gap_m) const;

  hand::JointAngles open_, closed_;
  Eigen::Matrix3d stage_; ///< outwards, from the thumb to the index finger, across; left: mirrored
};

} // namespace nendo::motions
