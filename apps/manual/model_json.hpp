#pragma once
// A description of a command as JSON text. By it, a program that another one starts takes part in
// the other's manual and completions.

#include <string>

#include <nendo/base/result.hpp>

#include "cli/command_model.hpp"

namespace nendo::manual {

/// The description with all of its options and commands, in one line.
std::string model_json(const cli::CommandModel& command);
/// Reads what model_json() returned. Error: bad_input.
Result<cli::CommandModel> parse_model(const std::string& json);

} // namespace nendo::manual
