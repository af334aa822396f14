#pragma once
// The constant rotations of the hand's shape, which forward and inverse kinematics share.

#include <array>
#include <numbers>

#include <nendo/base/units.hpp>

namespace nendo::hand {

// At zero angles the thumb lies beside the index finger. Its bones diverge from it by the width of
// the web, and its nail is turned towards the thumb's side, so that its flexion runs across the
// palm and not towards it.
inline constexpr double thumb_rest_abduction_rad = from_degrees(15);

// The thumb's carpometacarpal joint is a saddle. Its axes of flexion and abduction are those of the
// trapezium, 48 degrees flexed, 38 abducted and 80 pronated to the third metacarpal (W. P. Cooney,
// M. J. Lucca, E. Y. S. Chao, R. L. Linscheid, "The kinesiology of the thumb trapeziometacarpal
// joint", J. Bone Joint Surg. 63-A, 1981, 1371-1381), where the first axis is fixed in the
// trapezium and the second in the metacarpal (A. Hollister et al., "The axes of rotation of the
// thumb carpometacarpal joint", J. Orthop. Res. 10, 1992, 454-460). A glove's angles say where
// such a thumb points: roll carries it round the index metacarpal, abduction away from that. The
// saddle determines how far the thumb is then turned about its own axis; it adds the 17 degrees of
// pronation that Cooney found over 53 of flexion. The line below approximates that to 5 degrees
// (root mean square; 14 at a corner) for roll from 0 to 90 and abduction from 0 to 50 degrees. Roll
// and abduction alone would turn the thumb much farther, and the rolled thumb would bend away from
// the fingers.
inline constexpr double thumb_pronation_rad = from_degrees(47);
inline constexpr double pronation_by_roll = -0.41;
inline constexpr double pronation_by_abduction = -0.27;

// How much of the palm's arch moves each metacarpal, from index to little finger. The little
// finger's metacarpal moves most, the ring finger's about half as much; those of index and middle
// finger are fixed to the carpus.
inline constexpr std::array<double, 4> arch_share{0.0, 0.0, 0.5, 1.0};

} // namespace nendo::hand
