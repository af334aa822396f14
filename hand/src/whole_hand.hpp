#pragma once
// The whole hand's part of inverse kinematics: all angles at once, for what the fingers share, the
// wrist and the palm. Everything stands in the frame of the forearm's end, as a right hand's.

#include <array>

#include "angle_rows.hpp"
#include "finger_reach.hpp"

namespace nendo::hand {

/// Where the wrist's own angles turn the hand.
Eigen::Matrix3d wrist_turn(double pitch_rad, double yaw_rad) noexcept;

using Chains = std::array<FingerChain, finger_count>;

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

struct WholeHand {
  const Chains& chains;
  const Aims& aims;
  const PalmAim& palm;

  /// Forms the hand and reaches, from `at`, palm and wrist as far as `box` lets them move. Returns
  /// its iterations. Wait-free.
  int solve(const Box<row_size>& box, double enough_m, AllAngles& at) const noexcept;

  /// From where the palm is with the wrist turned so to where it is to be: the root mean square of
  /// its origin's and axes' ends' distances, half a hand away from it.
  double palm_off_m(const Eigen::Matrix3d& wrist_turn) const noexcept;
};

} // namespace nendo::hand
