#pragma once
// Buttons of the table of commands, for windows.

#include <string_view>

#include "commands/commands.hpp"

namespace nendo::viewer {

/// Draws the row's button, grey where the command is not possible. A width of 0 is that of its
/// text. Returns whether it was pressed.
bool row_button(const commands::Row& row, const commands::Situation& now, float width);
/// Shows the row's help and keys, or why it is not possible, while the mouse is over the latest
/// item.
void show_help(const commands::Row& row, const commands::Situation& now);
/// Shows a text, if there is one in place of the row's help, and the keys of the row of that name.
void show_help(std::string_view name, std::string_view text = {});

} // namespace nendo::viewer
