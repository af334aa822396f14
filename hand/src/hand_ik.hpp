#pragma once
// Inverse kinematics of the whole hand: solves for all angles at once, because the fingers share
// the palm's arch and the wrist. Everything is in the frame of the forearm's end, as a right
// hand's.

#include <array>

#include "angle_rows.hpp"
#include "finger_reach.hpp"

namespace nendo::hand {

/// Returns the rotation of the palm that the wrist's two angles make.
Eigen::Matrix3d wrist_turn(double pitch_rad, double yaw_rad) noexcept;

using Chains = std::array<FingerChain, finger_count>;

/// Where a fingertip is to be, in metres.
struct Aim {
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
  double weight = 0.0; ///< 1 at most; 0: none
};
using Aims = std::array<Aim, finger_count>;

/// The palm's pose: `rest` with a straight wrist, `wanted` where it is to be.
struct PalmAim {
  Eigen::Isometry3d rest = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d wanted = Eigen::Isometry3d::Identity();
  double weight = 0.0; ///< beside the fingertips'; 0: none
};

/// All members must outlive it.
struct HandIk {
  const Chains& chains;
  const Aims& aims;
  const PalmAim& palm;

  /// Moves `at`, within `box`, until the fingertips and the palm are within `enough_m` of where
  /// they are to be, or no nearer pose is found. Returns the number of iterations. Wait-free.
  int solve(const Box<row_size>& box, double enough_m, AllAngles& at) const noexcept;

  /// Returns how far the palm is from where it is to be when the wrist is turned so: the root mean
  /// square distance of its origin and of a point on each axis, half a hand away from the origin.
  double palm_off_m(const Eigen::Matrix3d& wrist_turn) const noexcept;
};

} // namespace nendo::hand
