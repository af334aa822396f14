#pragma once
// The command table in windows: keys, buttons and tooltips.

#include <string_view>

#include "commands/commands.hpp"

namespace nendo::viewer {

/// One key with its modifiers.
struct KeyStroke {
  int key = 0; ///< GLFW's number; 0: not available in windows
  bool control = false;
  bool shift = false;

  /// Returns whether these modifiers match. Shift counts for letters, and with control, but not for
  /// symbols, which need it only on some keyboards.
  bool fits(bool with_control, bool with_shift) const noexcept;
};
/// Returns the stroke for a key name of the table: "e", "E", "Home", "Ctrl Shift Z".
KeyStroke stroke_of(std::string_view name) noexcept;

/// Returns whether a key of the row was pressed since the last picture. With row.repeats, a key
/// that is held down repeats.
bool is_struck(const commands::Row& row);

/// Draws the row's button, disabled if the command is not possible. Width 0: as wide as its text.
/// Returns whether it was pressed.
bool row_button(const commands::Row& row, const commands::State& now, float width);
/// Shows a tooltip with the row's help and keys, or its refusal, for the latest item.
void show_help(const commands::Row& row, const commands::State& now);
/// Shows a tooltip with `text`, or else the row's help, and the keys of the row of that name.
void show_help(std::string_view name, std::string_view text = {});

} // namespace nendo::viewer
