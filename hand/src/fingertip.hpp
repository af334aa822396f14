#pragma once
// One fingertip as a function of its finger's four angles, with the derivatives: what inverse
// kinematics needs of the hand, without the other joints. A right hand's, in the frame of its wrist
// joint, behind the wrist's own angles.

#include <array>

#include <Eigen/Core>

#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// A finger: MCP flexion, MCP abduction, PIP, DIP. The thumb: roll, abduction, MCP, IP. Radians, as
/// JointAngles has them and in its order.
using FourAngles = Eigen::Vector4d;

struct Fingertip {
  Eigen::Vector3d position_m;
  Eigen::Matrix<double, 3, 4> by_angle; ///< m / rad
};

class FingerChain {
public:
  /// finger: 0, the thumb, to 4.
  FingerChain(const HandSkeleton& skeleton, std::size_t finger) noexcept;

  /// With the palm arched. Wait-free.
  Fingertip tip(const FourAngles& angles, double palm_arch_rad) const noexcept;
  /// The derivative of a tip's position by the palm's arch.
  Eigen::Vector3d by_arch(const Eigen::Vector3d& tip_m) const noexcept;
  bool moves_with_arch() const noexcept { return arch_share_ > 0.0; }

private:
  Fingertip thumb_tip(const FourAngles& angles) const noexcept;
  Fingertip finger_tip(const FourAngles& angles) const noexcept;

  bool is_thumb_;
  double arch_share_;
  Eigen::Vector3d base_m_; ///< of the metacarpal
  Eigen::Vector3d head_m_; ///< from there to the MCP joint; fingers only
  std::array<double, 3> bones_m_;
};

} // namespace nendo::hand
