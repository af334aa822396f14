#pragma once
// Makes manual pages of commands, in the language of man(7).

#include <string>

#include "cli/command_model.hpp"

namespace nendo::manual {

/// The origin of a page, as its head and foot show it.
struct PageOrigin {
  std::string date;    ///< "2026-11-22"
  std::string version; ///< "0.2.0"
};

/// Returns nendo.1, the page of the program and its commands.
std::string program_page(const cli::CommandModel& program, const PageOrigin& origin);
/// Returns nendo-COMMAND.1, the page of one command with the commands below it.
std::string command_page(const cli::CommandModel& program, const cli::CommandModel& command,
                         const PageOrigin& origin);

} // namespace nendo::manual
