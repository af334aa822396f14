#pragma once
// Where a hand's joints are at the time that an application asks for, and how fast they move.

#include <array>
#include <cstdint>

#include <Eigen/Geometry>

#include "openxr/segment_view.hpp"

namespace nendo::openxr {

/// Joints on the stage at one time.
struct MovingHand {
  HandPose joints;
  bool has_velocity = false;
  std::array<Eigen::Vector3d, joint_count> linear_m_per_s;
  std::array<Eigen::Vector3d, joint_count> angular_rad_per_s;
};

/// The farthest time from the newest record to which joints are extrapolated.
inline constexpr std::int64_t max_extrapolation_ns = 50'000'000;

/// Returns the joints at `time_ns` of CLOCK_MONOTONIC, by the velocities between both poses of
/// `hand`, at most max_extrapolation_ns before or after the newest one. Joints turn, and carry the
/// next ones along, so that bones keep their lengths. A hand that is silent, or has no earlier
/// pose, stays where it is and has no velocity. Pure, wait-free.
MovingHand at_time(const PublishedHand& hand, std::int64_t time_ns) noexcept;

} // namespace nendo::openxr
