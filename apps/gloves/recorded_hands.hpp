#pragma once
// The calibration that was in force when a glove was recorded.

#include <optional>

#include <nendo/driver/glove.hpp>
#include <nendo/recording/setup.hpp>

namespace nendo::gloves {

/// Of the hand of that side in the recording that `glove` replays; nothing for other gloves, and
/// where it was not recorded. Blocks.
std::optional<recording::HandSetup> recorded_hand(const driver::GloveInfo& glove, Side side);

} // namespace nendo::gloves
