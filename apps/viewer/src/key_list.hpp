#pragma once
// What `?` shows in every window.

#include <span>

namespace nendo::viewer {

struct KeyLine {
  const char* key;
  const char* does;
};

/// A window's own keys, those that all windows have, and its own uses of the mouse after the
/// camera's. shown: becomes false when it is closed.
void draw_key_list(std::span<const KeyLine> own, const char* mouse, bool& shown);

} // namespace nendo::viewer
