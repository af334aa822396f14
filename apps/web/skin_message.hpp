#pragma once
// The message with the skin of a hand (PROTOCOL.md). Clients bend it by the poses of the joints, so
// that their hands look like the window's.

#include <cstddef>
#include <vector>

namespace nendo::web {

/// Returns the skin of an open right hand: its joints' poses, and for each vertex the position and
/// the joints that carry it. Takes some tens of milliseconds. Allocates.
std::vector<std::byte> skin_message();

} // namespace nendo::web
