#pragma once
// All angles of a hand in one row, as the solver of inverse kinematics takes them. They are in the
// order of Angle: four for the thumb and for each finger, then those of the whole hand.

#include <nendo/hand/angle.hpp>
#include <nendo/hand/inverse_kinematics.hpp>

#include "bounded_least_squares.hpp"

namespace nendo::hand {

inline constexpr int arch_at = static_cast<int>(Angle::palm_arch);
inline constexpr int pitch_at = static_cast<int>(Angle::wrist_pitch);
inline constexpr int yaw_at = static_cast<int>(Angle::wrist_yaw);
inline constexpr int row_size = static_cast<int>(angle_count);
using AllAngles = Eigen::Matrix<double, row_size, 1>;

AllAngles row_of(const JointAngles& angles) noexcept;
JointAngles angles_of(const AllAngles& row) noexcept;

/// Returns the limits as a box. Ranges that are not valid are replaced by the default ones.
Box<row_size> box_of(const AngleLimits& limits) noexcept;
/// Returns the row clamped to the box. An angle that is not finite counts as zero.
AllAngles clamped(AllAngles row, const Box<row_size>& box) noexcept;

} // namespace nendo::hand
