#pragma once
// The only command of nendo-ros2.

#include "cli/command.hpp"

namespace nendo::ros2 {

inline constexpr const char* program_summary =
    "nendo-ros2: publishes the hands of a run of nendo to programs of ROS 2.";
inline constexpr const char* command_name = "publish";

/// Adds the command, which publishes until a signal asks it to stop.
void add_command(cli::Command& program);

} // namespace nendo::ros2
