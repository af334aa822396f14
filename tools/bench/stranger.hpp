#pragma once
// A second kind of synthetic wearer, whom no default was made for: a hand of its own, and sensors
// that bend, lag, creep, slip and read each other. Its poses are off by several degrees. `nendo
// bench wearers` writes such wearers down.

#include <cstdint>

#include "bench/judged_wearer.hpp"
#include "bench/stranger_hand.hpp"

namespace nendo::bench {

/// Which errors a stranger has; each part is 1 for all of it and 0 for none.
struct StrangerErrors {
  double curvature = 1.0;
  double hysteresis = 1.0;
  double creep = 1.0;
  double cross_talk = 1.0; ///< also the cross-talk that the product's couplings do not have
  double scatter = 1.0;    ///< scatter of poses
  double slip = 1.0;       ///< after the calibration
};

/// Makes one wearer, the same for the same seed: captures, a minute of motion, and the same after
/// the glove has been put on again.
JudgedWearer make_stranger(std::uint64_t seed, SensorMask sensors, const StrangerErrors& errors);

/// Returns the hand of the wearer that make_stranger() makes of the same seed.
StrangerHand hand_of_stranger(std::uint64_t seed);

} // namespace nendo::bench
