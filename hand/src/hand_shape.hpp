#pragma once
// The constant turns of the hand's shape, which forward and inverse kinematics share.

#include <array>
#include <numbers>

#include <nendo/base/units.hpp>

#include "turns.hpp"

namespace nendo::hand {

// At zero angles the thumb lies beside the index finger, its bones parting from it by the width of
// the web, and its nail turned towards the thumb's side: its flexion runs across the palm and not
// towards it.
inline constexpr double thumb_rest_abduction_rad = from_degrees(15);
inline constexpr Turn thumb_pronation{std::numbers::sqrt3 / 2, 0.5}; // 60 degrees

// Index to little finger. The little finger's metacarpal moves most when the palm arches, the ring
// finger's about half as much; those of index and middle finger are fixed to the carpus.
inline constexpr std::array<double, 4> arch_share{0.0, 0.0, 0.5, 1.0};

} // namespace nendo::hand
