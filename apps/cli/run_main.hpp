#pragma once
// What the main functions of the programs share.

#include <functional>
#include <string>
#include <string_view>

#include "cli/command.hpp"

namespace nendo::cli {

/// Returns the name by which messages call this program: "nendo" until run_main() sets another one.
std::string_view program_name() noexcept;

/// Runs the program of this name, a literal, and returns its exit code: that of `run`, or 1 with a
/// message after an exception. Call it before any other thread exists.
int run_main(std::string_view name, const std::function<int()>& run);

/// Does the same as run_program() with `command` in front of the arguments, unless it is empty.
int run_program_with(std::string command, int argc, char** argv, const std::string& summary,
                     const std::function<void(Command&)>& add_commands);

} // namespace nendo::cli
