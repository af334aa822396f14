#pragma once
// Converts the description of a command to JSON text and back. By that text, a program that another
// one starts gets into the other's manual and completions.

#include <string>

#include <nendo/base/result.hpp>

#include "cli/command_model.hpp"

namespace nendo::manual {

/// Returns the description with all of its options and commands, in one line.
std::string model_json(const cli::CommandModel& command);
/// Reads what model_json() returned. Error: bad_input.
Result<cli::CommandModel> parse_model(const std::string& json);

} // namespace nendo::manual
