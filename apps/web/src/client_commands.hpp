#pragma once
// A strict parser for the commands that a client may send (PROTOCOL.md). It does not allocate.

#include <optional>
#include <string_view>

#include <nendo/flow/command.hpp>

namespace nendo::web {

/// The radii that a client may ask for. This is more than fingers can shape with, and a loop can
/// begin with each of them.
inline constexpr double min_radius_m = 0.001;
inline constexpr double max_radius_m = 10.0;
/// How far a quaternion's length may be from 1. Six decimals of each part are precise enough.
inline constexpr double max_norm_error = 0.01;

/// The command that the text means; nothing if it is none, or if a number in it is out of range.
/// The quaternion of a wrist is normalised.
std::optional<flow::Command> parse_command(std::string_view text) noexcept;

} // namespace nendo::web
