#pragma once
// Reduces a pose for each frame to a few keys.

#include <limits>
#include <span>
#include <vector>

#include "timeline/point_sway.hpp"

namespace nendo::timeline {

/// The greatest allowed distance between a frame and the curve through the keys. With 0, every
/// frame that is not exactly on the curve becomes a key.
struct Tolerance {
  double angle_rad =
      std::numeric_limits<double>::infinity();              ///< of any joint, and the wrist's turn
  double tip_m = std::numeric_limits<double>::infinity();   ///< of any fingertip, and the wrist
  double point_m = std::numeric_limits<double>::infinity(); ///< of any point of a puppet
};

struct Deviation {
  double angle_rad = 0.0; ///< as in Tolerance
  double tip_m = 0.0;
  double point_m = 0.0; ///< PointSway::off_m()
};

/// Returns the deviation between two poses of a hand that touches the model.
Deviation deviation_between(const hand::HandSkeleton& skeleton, const Key& one, const Key& other);

struct Reduction {
  std::vector<Key> keys;
  std::size_t frames = 0;
  Deviation worst; ///< of any frame from the HandCurve of the keys
};

/// Returns keys for the frames, which must fulfil the conditions of HandTrack::keys. The first and
/// the last frame become keys. As long as the curve is too far off, the worst frame between two
/// keys becomes a key. At the end, keys that are not needed are removed. With `sway`, the points of
/// the puppet that the hand plays count, and the frames at which its functions grab, and
/// those before them, stay keys.
Reduction reduce_keys(const hand::HandSkeleton& skeleton, std::span<const Key> frames,
                      const Tolerance& tolerance, const PointSway* sway = nullptr);

} // namespace nendo::timeline
