#pragma once
// The wearer of a glove that was recorded.

#include <optional>

#include <nendo/driver/glove.hpp>
#include <nendo/hand/wearer.hpp>

namespace nendo::gloves {

/// Returns the calibrations and sizes with which the hand of that side was recorded, if `glove`
/// replays a recording; nullopt for other gloves, and if there is no such hand in it. What
/// adaptation had learned is left out. Blocks.
std::optional<hand::Wearer> recorded_wearer(const driver::GloveInfo& glove, Side side);

} // namespace nendo::gloves
