#pragma once
// How much of what was made of a timeline is still true after an edit.

#include <cstdint>

#include <nendo/timeline/timeline.hpp>

namespace nendo::timeline {

/// So many frames at the beginning are the same in both, bit for bit; perhaps some more are.
/// frames_before, frames_after: Player::frame_count(). The rates are equal. No more than `most` are
/// looked at.
std::uint64_t unchanged_frames(const Timeline& before, std::uint64_t frames_before,
                               const Timeline& after, std::uint64_t frames_after,
                               std::uint64_t most);

} // namespace nendo::timeline
