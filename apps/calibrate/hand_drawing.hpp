#pragma once
// Draws a hand in its pose with characters: outlines of palm and fingers, where nearer parts hide
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

/// Returns `rows` lines of `columns` printable ASCII characters. The forearm of `pose` must end at
/// the origin and point along -Z. The hand is centred, and drawn so large that a flat hand with
/// spread fingers fits. Characters are taken to be twice as high as wide.
std::vector<std::string> draw_hand(const hand::HandPose& pose, Side side, HandView view,
                                   int columns, int rows);

} // namespace nendo::calibrate
