#pragma once
// Says where a hand is in space, which no glove measures. The hand stays where it was placed until
// it is moved, for example with a mouse or a tracker.

#include <array>
#include <cstdint>
#include <string_view>

#include <Eigen/Geometry>

#include <nendo/driver/sample.hpp>

namespace nendo::flow {

struct NENDO_API WristMove {
  Side side = Side::right;                     ///< as which the hand shapes
  std::array<double, 3> position_m{};          ///< on the stage
  std::array<double, 4> turn_xyzw{0, 0, 0, 1}; ///< a quaternion; read as if of length 1

  static constexpr double farthest_m = 100.0;

  static WristMove to(Side side, const Eigen::Isometry3d& T_stage_wrist) noexcept;
  /// Returns whether the position is within farthest_m of the stage's middle and the quaternion is
  /// not zero. The loop refuses a move that is not usable.
  bool is_usable() const noexcept;
  /// What is said where a move is refused.
  static constexpr std::string_view refusal =
      "a hand cannot be moved there: it must stay within 100 m of the stage's middle on each axis, "
      "and its turn must be a quaternion that is not zero";
  /// Returns T_stage_wrist. The move must be usable.
  Eigen::Isometry3d pose() const noexcept;

  friend bool operator==(const WristMove&, const WristMove&) = default;
};

} // namespace nendo::flow
