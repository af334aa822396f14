#pragma once
// Completion of the program's command line, for three shells.

#include <string>

#include "cli/command_model.hpp"

namespace nendo::manual {

/// Words of the commands, options and their choices; file names where any value will do.
std::string bash_completion(const cli::CommandModel& program);
std::string zsh_completion(const cli::CommandModel& program);
std::string fish_completion(const cli::CommandModel& program);

} // namespace nendo::manual
