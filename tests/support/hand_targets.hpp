#pragma once
// Hands and fingertip targets for inverse kinematics, and how far a solution is from them.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <nendo/hand/inverse_kinematics.hpp>

#include "support/random_poses.hpp"

namespace nendo::test {

using namespace nendo::hand;
using Eigen::Isometry3d;
using Eigen::Vector3d;

inline constexpr double tenth_mm = 1e-4;

/// Returns pointers to all angles in one row, so that tests can visit every angle of a hand.
inline std::vector<double*> angles_in(JointAngles& a) {
  std::vector<double*> row{&a.thumb_roll_rad, &a.thumb_abduction_rad, &a.thumb_mcp_flexion_rad,
                           &a.thumb_ip_flexion_rad};
  for (auto& f : a.fingers) {
    row.insert(row.end(),
               {&f.mcp_flexion_rad, &f.mcp_abduction_rad, &f.pip_flexion_rad, &f.dip_flexion_rad});
  }
  row.insert(row.end(), {&a.palm_arch_rad, &a.wrist_pitch_rad, &a.wrist_yaw_rad});
  return row;
}
inline constexpr std::size_t shared_at = 20; // palm arch, wrist pitch, wrist yaw

inline JointAngles random_angles_within_limits(std::mt19937& random) {
  AngleLimits limits = default_angle_limits();
  JointAngles angles;
  const auto low = angles_in(limits.low);
  const auto high = angles_in(limits.high);
  const auto all = angles_in(angles);
  for (std::size_t k = 0; k < all.size(); ++k)
    *all[k] = std::uniform_real_distribution<double>(*low[k], *high[k])(random);
  return angles;
}

inline bool within(AngleLimits limits, JointAngles angles) {
  const auto low = angles_in(limits.low);
  const auto high = angles_in(limits.high);
  const auto all = angles_in(angles);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!(*all[k] >= *low[k] && *all[k] <= *high[k])) return false;
  }
  return true;
}

inline double farthest_apart(JointAngles a, JointAngles b) {
  const auto as = angles_in(a);
  const auto bs = angles_in(b);
  double farthest = 0.0;
  for (std::size_t k = 0; k < as.size(); ++k)
    farthest = std::max(farthest, std::abs(*as[k] - *bs[k]));
  return farthest;
}

inline FingertipTargets targets_at(const Eigen::Matrix<double, 3, 5>& places) {
  FingertipTargets targets;
  for (std::size_t f = 0; f < finger_count; ++f)
    targets[f] = {places.col(static_cast<Eigen::Index>(f)), 1.0};
  return targets;
}

/// Returns the distance from each tip to its target, by the forward kinematics of a solution.
inline std::array<double, finger_count> distances(const HandSkeleton& skeleton,
                                                  const Isometry3d& base,
                                                  const FingertipTargets& targets,
                                                  const JointAngles& angles) {
  const auto tips = skeleton.pose(angles, base).fingertip_positions();
  std::array<double, finger_count> all{};
  for (std::size_t f = 0; f < finger_count; ++f) {
    if (targets[f].weight > 0.0)
      all[f] = (tips.col(static_cast<Eigen::Index>(f)) - targets[f].position_m).norm();
  }
  return all;
}

inline double most(const std::array<double, finger_count>& all) {
  return *std::max_element(all.begin(), all.end());
}

/// Returns a start pose that has palm and wrist as they were when the targets were made, because
/// nothing else moves them.
inline JointAngles resting_with_wrist_of(const JointAngles& angles) {
  JointAngles rest;
  rest.palm_arch_rad = angles.palm_arch_rad;
  rest.wrist_pitch_rad = angles.wrist_pitch_rad;
  rest.wrist_yaw_rad = angles.wrist_yaw_rad;
  return rest;
}

inline JointAngles near(JointAngles angles, double by_rad, std::mt19937& random) {
  std::uniform_real_distribution<double> off(-by_rad, by_rad);
  const auto all = angles_in(angles);
  for (std::size_t k = 0; k < shared_at; ++k)
    *all[k] += off(random);
  return angles;
}

} // namespace nendo::test
