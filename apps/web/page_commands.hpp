#pragma once
// The table of commands and the description of the settings, as the page has them.

#include <string>

namespace nendo::web {

/// Returns the rows that the page has, as a list in JavaScript, of which each has name, keys, help,
/// button, buttonOn, isForRun and isSetting.
std::string page_commands();

/// Returns an object in JavaScript with the settings by their names, of which each has label, and
/// if it is chosen by a slider, min and max.
std::string page_settings();

} // namespace nendo::web
