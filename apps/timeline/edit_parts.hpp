#pragma once
// Helpers that several edits share.

#include <string>

#include <nendo/base/result.hpp>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// Return the track of a hand. Error: usage if there is no such hand, or if the hand has no such
/// key.
Result<HandTrack*> track_of(Timeline& timeline, Side side);
Result<HandTrack*> track_with_key(Timeline& timeline, Side side, std::size_t key);

/// Returns a name such as "left hand, key 3".
std::string name_of_key(Side side, std::size_t key);

} // namespace nendo::timeline
