#pragma once
// A hand as plain OSC messages, for instruments, lights and scripts. apps/publish/OSC.md lists
// them.

#include <nendo/base/side.hpp>
#include <nendo_publish.h>

#include "publish/osc_packer.hpp"

namespace nendo::publish {

/// Adds the messages of a hand that a glove drives.
void add_hand_messages(Side side, const nendo_publish_hand& hand,
                       const nendo_publish_hand_state& state, OscPacker& packer);

} // namespace nendo::publish
