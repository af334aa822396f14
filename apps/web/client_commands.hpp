#pragma once
// A strict parser for the commands that a client may send (PROTOCOL.md). It does not allocate.

#include <optional>
#include <string_view>
#include <variant>

#include <nendo/flow/command.hpp>

#include "commands/commands.hpp"

namespace nendo::web {

/// How far the length of a quaternion may be from 1. Six decimals for each part are precise enough.
inline constexpr double max_norm_error = 0.01;

/// A command, or a row of the table, which a client gives by its name as a person does by its key:
/// what becomes of it depends on the run (commands::press()).
using ClientCommand = std::variant<flow::Command, const commands::Row*>;

/// Returns the command that the text means, or nothing if it is no command or if a number in it is
/// out of range. The quaternion of a wrist is normalised. Settings have the usual numbers where the
/// text has none: the length of a piece, and the filter's.
std::optional<ClientCommand> parse_command(std::string_view text) noexcept;

} // namespace nendo::web
