#pragma once
// Completion of the program's command line, for three shells.

#include <string>

#include "manual/command_model.hpp"

namespace nendo::app {

/// Words of the commands, options and their choices; file names where any value will do.
std::string bash_completion(const CommandModel& program);
std::string zsh_completion(const CommandModel& program);
std::string fish_completion(const CommandModel& program);

} // namespace nendo::app
