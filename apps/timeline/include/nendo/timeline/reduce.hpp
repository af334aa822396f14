#pragma once
// From a pose a frame to few keys.

#include <limits>
#include <span>
#include <vector>

#include <nendo/timeline/timeline.hpp>

namespace nendo::timeline {

/// How far a curve through the keys may be from any frame; 0: every frame that is not on it by
/// itself is a key.
struct Tolerance {
  double angle_rad =
      std::numeric_limits<double>::infinity();            ///< of any joint, and the wrist's turn
  double tip_m = std::numeric_limits<double>::infinity(); ///< of any fingertip, and the wrist
};

struct Deviation {
  double angle_rad = 0.0; ///< as in Tolerance
  double tip_m = 0.0;
};

/// Between two poses of a hand.
Deviation deviation_between(const hand::HandSkeleton& skeleton, const Key& one, const Key& other);

struct Reduction {
  std::vector<Key> keys;
  std::size_t frames = 0;
  Deviation worst; ///< of any frame from the HandCurve of the keys
};

/// frames: as a HandTrack's keys. First and last are kept; where the curve is too far off, the
/// worst frame between two keys becomes one, until none is; what then is not needed goes.
Reduction reduce_keys(const hand::HandSkeleton& skeleton, std::span<const Key> frames,
                      const Tolerance& tolerance);

} // namespace nendo::timeline
