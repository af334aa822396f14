#pragma once
// Where a hand is in space, which no glove measures: it stays where it was placed until somebody
// moves it, with a mouse, say, or a tracker.

#include <array>
#include <cstdint>

#include <Eigen/Geometry>

#include <nendo/driver/sample.hpp>

namespace nendo::flow {

struct WristMove {
  Side side = Side::right;                     ///< as which the hand shapes
  std::array<double, 3> position_m{};          ///< on the stage
  std::array<double, 4> turn_xyzw{0, 0, 0, 1}; ///< a quaternion; read as if of length 1

  static constexpr double farthest_m = 100.0;

  static WristMove to(Side side, const Eigen::Isometry3d& T_stage_wrist) noexcept;
  /// Within farthest_m of the stage's middle, with a quaternion that has a length. What is not is
  /// refused by the loop.
  bool is_usable() const noexcept;
  /// T_stage_wrist, of one that is usable.
  Eigen::Isometry3d pose() const noexcept;

  friend bool operator==(const WristMove&, const WristMove&) = default;
};

} // namespace nendo::flow
