#pragma once
// The table of commands, as the page has it.

#include <string>

namespace nendo::web {

/// Returns the rows that the page has, as a list in JavaScript, of which each has name, keys, help,
/// button, buttonOn, isForRun and isSetting.
std::string page_commands();

} // namespace nendo::web
