#pragma once
// A frame of a loop: of a running session, a replayed recording, or another program's run.

#include <array>
#include <cstdint>
#include <limits>

#include <nendo/flow/frame.hpp>

#include "python/arrays.hpp"
#include "python/hands.hpp"

namespace nendo::python {

inline constexpr std::size_t numbers_per_joint = 7; ///< position, quaternion x y z w
inline constexpr std::size_t numbers_per_hand = hand::joint_count * numbers_per_joint;

/// Copies of a frame's hands. NaN where there is no hand, or no angle is known.
struct FrameCopy {
  std::uint64_t number = 0; ///< the record, or the tick on the grid
  double time_s = 0.0;
  bool held = false;
  double units_per_metre = 1.0;
  std::array<bool, 2> present{}, silent{};
  std::array<double, 2 * numbers_per_hand> hands;
  std::array<double, 2 * hand::angle_count> angles;

  FrameCopy() {
    hands.fill(std::numeric_limits<double>::quiet_NaN());
    angles.fill(std::numeric_limits<double>::quiet_NaN());
  }
};

FrameCopy copy_of(const flow::Frame& frame);

/// The shapes of a frame's arrays.
inline const Shape hands_shape{2, hand::joint_count, numbers_per_joint};
inline const Shape angles_shape{2, hand::angle_count};

} // namespace nendo::python
