#pragma once
// All angles of a hand in one row, as the solver of inverse kinematics takes them: four for the
// thumb and for each finger, in the order of FourAngles, then what the whole hand shares.

#include <nendo/hand/inverse_kinematics.hpp>

#include "bounded_least_squares.hpp"

namespace nendo::hand {

inline constexpr int arch_at = 20;
inline constexpr int pitch_at = 21;
inline constexpr int yaw_at = 22;
inline constexpr int angle_count = 23;
using AllAngles = Eigen::Matrix<double, angle_count, 1>;

AllAngles row_of(const JointAngles& angles) noexcept;
JointAngles angles_of(const AllAngles& row) noexcept;

/// Ranges that are none are replaced by the default ones.
Box<angle_count> box_of(const AngleLimits& limits) noexcept;
/// What is not finite counts as zero.
AllAngles clamped(AllAngles row, const Box<angle_count>& box) noexcept;

} // namespace nendo::hand
