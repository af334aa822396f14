#pragma once
// The table of commands and the description of the settings, as the page and other clients have
// them.

#include <string>

#include "commands/commands.hpp"

namespace nendo::web {

/// Returns the rows that the page has, as a list in JavaScript, of which each has name, keys, help,
/// button, buttonOn, isForRun and isSetting.
std::string page_commands();

/// Returns an object in JavaScript with the settings by their names, of which each has label, and
/// if it is chosen by a slider, min and max. The brushes have choices.
std::string page_settings();

/// Returns the text of the message about commands: a line for each that is on or not possible, in
/// the order of the table. It has the command's name, "on" or "off", and why the command is not
/// possible, with tabs between.
std::string command_states(const commands::Situation& now);

} // namespace nendo::web
