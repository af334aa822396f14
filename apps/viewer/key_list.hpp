#pragma once
// The list of keys that `?` shows in every window.

#include <cstdint>

namespace nendo::viewer {

/// Draws the keys that the table of commands has for `places`, and the uses of the mouse: those of
/// the camera, then the window's own. `shown` becomes false when the list is closed.
void draw_key_list(std::uint8_t places, const char* mouse, bool& shown);

} // namespace nendo::viewer
