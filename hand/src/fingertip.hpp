#pragma once
// One fingertip as a function of its finger's four angles, with the derivatives. Inverse kinematics
// needs only this of the hand, not the other joints. Everything is of a right hand, in the frame of
// its wrist joint, after the wrist's own angles.

#include <array>

#include <Eigen/Core>

#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// The angles of a finger (MCP flexion, MCP abduction, PIP, DIP) or of the thumb (roll, abduction,
/// MCP, IP), in radians, as in JointAngles and in its order.
using FourAngles = Eigen::Vector4d;

struct Fingertip {
  Eigen::Vector3d position_m;
  Eigen::Matrix<double, 3, 4> by_angle; ///< m / rad
};

class FingerChain {
public:
  /// `finger` is 0 for the thumb to 4 for the little finger.
  FingerChain(const HandSkeleton& skeleton, std::size_t finger) noexcept;
  /// The same, of the finger's pad in place of its tip.
  static FingerChain to_pad(const HandSkeleton& skeleton, std::size_t finger) noexcept;

  /// Returns the tip at these angles, with the palm arched by `palm_arch_rad`. Wait-free.
  Fingertip tip(const FourAngles& angles, double palm_arch_rad) const noexcept;
  /// Returns the derivative of a tip's position by the palm's arch, in m / rad.
  Eigen::Vector3d by_arch(const Eigen::Vector3d& tip_m) const noexcept;
  bool moves_with_arch() const noexcept { return arch_share_ > 0.0; }

private:
  Fingertip thumb_tip(const FourAngles& angles) const noexcept;
  Fingertip finger_tip(const FourAngles& angles) const noexcept;

  bool is_thumb_;
  double arch_share_;
  Eigen::Vector3d base_m_; ///< base of the metacarpal
  Eigen::Vector3d head_m_; ///< from there to the MCP joint; fingers only
  std::array<double, 3> bones_m_;
  double last_turn_rad_ = 0.0; ///< bend of the last one at zero angles
  // Of the thumb: the axes in which it rolls, and its angles at zero. Of a finger: the tilt of its
  // knuckle's axis, as sine and cosine.
  Eigen::Matrix3d thumb_axes_;
  double thumb_rest_rad_;
  ThumbPronation pronation_;
  Eigen::Vector2d tilt_;
};

} // namespace nendo::hand
