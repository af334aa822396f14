#pragma once
// A strict parser for the commands that a client may send (PROTOCOL.md).

#include <string_view>
#include <variant>

#include <nendo/base/result.hpp>
#include <nendo/flow/command.hpp>

#include "commands/commands.hpp"
#include "web/named_settings.hpp"

namespace nendo::web {

/// How far the length of a quaternion may be from 1. Six decimals for each part are precise enough.
inline constexpr double max_norm_error = 0.01;

/// A command; or a row of the table, which a client gives by its name as a person does by its key:
/// what becomes of it depends on the run (commands::press()); or the settings that a client
/// changes.
using ClientCommand = std::variant<flow::Command, const commands::Row*, NamedSettings>;

/// Returns the command that the text means. The quaternion of a wrist is normalised. Allocates only
/// for an error. Error: bad_input (it is no command, or a number in it is out of range), in at most
/// max_close_reason bytes.
Result<ClientCommand> parse_command(std::string_view text);

} // namespace nendo::web
