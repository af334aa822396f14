#pragma once
// Finds the wearer of a glove that was recorded.

#include <optional>

#include <nendo/driver/glove.hpp>
#include <nendo/hand/wearer.hpp>

namespace nendo::gloves {

/// Returns the calibrations and sizes with which the hand of that side was recorded, if `glove`
/// replays a recording. Returns nullopt for other gloves, and if the recording has no such hand.
/// What adaptation had learned is left out. Blocks.
std::optional<hand::Wearer> recorded_wearer(const driver::GloveInfo& glove, Side side);

} // namespace nendo::gloves
