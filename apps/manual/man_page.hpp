#pragma once
// Manual pages of commands, in the language of man(7).

#include <string>
#include <string_view>
#include <vector>

#include "cli/command_model.hpp"

namespace nendo::manual {

/// Where a page comes from, as its head and foot say.
struct PageOrigin {
  std::string date;    ///< "2026-11-22"
  std::string version; ///< "0.1.0"
};

/// nendo.1: the program and its commands.
std::string program_page(const cli::CommandModel& program, const PageOrigin& origin);
/// nendo-COMMAND.1: one of its commands, with the commands that this has.
std::string command_page(const cli::CommandModel& program, const cli::CommandModel& command,
                         const PageOrigin& origin);

} // namespace nendo::manual
