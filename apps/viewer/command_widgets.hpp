#pragma once
// The table of commands in windows: its keys, its buttons, and the list of keys.

#include <cstdint>
#include <string_view>
#include <vector>

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

/// Draws the row's button, grey where the command is not possible. A width of 0 is that of its
/// text. `now` is a commands::Situation or, for a timeline, commands::EditFacts. Returns whether it
/// was pressed.
template <class Now>
bool row_button(const commands::Row& row, const Now& now, float width);
/// Draws the buttons of a timeline's group in one line, those with two strings twice as wide, and
/// adds what was pressed to `asked`.
void edit_buttons(commands::Buttons group, const commands::EditFacts& now, float width,
                  std::vector<commands::EditCommand>& asked);
/// Shows the row's help and keys, or why it is not possible, while the mouse is over the latest
/// item.
template <class Now>
void show_help(const commands::Row& row, const Now& now);
/// Shows a text, if there is one in place of the row's help, and the keys of the row of that name.
void show_help(std::string_view name, std::string_view text = {});

/// Draws the keys that the table of commands has for `places`, and the uses of the mouse: those of
/// the camera, then the window's own. `shown` becomes false when the list is closed.
void draw_key_list(std::uint8_t places, const char* mouse, bool& shown);

} // namespace nendo::viewer
