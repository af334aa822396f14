#pragma once
// Finds how many frames of a timeline are still valid after an edit.

#include <cstdint>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// Returns a number of frames at the beginning that are the same in both, bit for bit. It may be
/// too low, but never too high. `frames_before` and `frames_after` are Player::frame_count(). The
/// rates must be equal. At most `most` frames are compared.
std::uint64_t unchanged_frames(const Timeline& before, std::uint64_t frames_before,
                               const Timeline& after, std::uint64_t frames_after,
                               std::uint64_t most);

} // namespace nendo::timeline
