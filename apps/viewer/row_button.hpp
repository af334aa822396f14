#pragma once
// Buttons of the table of commands, for windows.

#include <string_view>
#include <vector>

#include "commands/commands.hpp"

namespace nendo::viewer {

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

} // namespace nendo::viewer
