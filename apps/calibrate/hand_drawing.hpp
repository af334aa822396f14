#pragma once
// A hand in its pose, drawn with characters: outlines of palm and fingers, the nearer before the
// farther ones.

#include <string>
#include <vector>

#include <nendo/hand/skeleton.hpp>

namespace nendo::calibrate {

/// From where a drawing shows the hand; the fingers of a flat hand point up in all of them.
enum class HandView {
  palm, ///< as one sees one's own palm
  side, ///< from the thumb's side
};

/// The pose is one whose forearm ends at the origin and points along -Z. `rows` lines of `columns`
/// printable ASCII characters. The hand is centred, and so large that a flat one with spread
/// fingers fits. Characters are taken to be twice as high as wide.
std::vector<std::string> draw_hand(const hand::HandPose& pose, Side side, HandView view,
                                   int columns, int rows);

} // namespace nendo::calibrate
