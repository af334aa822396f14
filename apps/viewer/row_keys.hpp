#pragma once
// Keys as the table of commands names them, for windows.

#include <string_view>

#include "commands/commands.hpp"

namespace nendo::viewer {

/// One key with its modifiers.
struct KeyStroke {
  int key = 0; ///< GLFW's number; 0: a window does not have the key
  bool control = false;
  bool shift = false;

  /// Returns whether it is this one. Shift matters for letters, and with control, but not for
  /// signs, which some keyboards have on other keys.
  bool fits(bool with_control, bool with_shift) const noexcept;
};
/// Returns the stroke of a key by its name in the table: "e", "E", "Home", "Ctrl Shift Z".
KeyStroke stroke_of(std::string_view name) noexcept;

/// Returns whether a key of the row has just gone down in the present picture. With row.repeats, a
/// key that is held down counts again at intervals.
bool is_struck(const commands::Row& row);

} // namespace nendo::viewer
