#pragma once
// Makes the completion of the program's command line for three shells.

#include <string>

#include "cli/command_model.hpp"

namespace nendo::manual {

/// These complete commands, options and their choices, and file names where any value is allowed.
std::string bash_completion(const cli::CommandModel& program);
std::string zsh_completion(const cli::CommandModel& program);
std::string fish_completion(const cli::CommandModel& program);

} // namespace nendo::manual
