#pragma once
// Commands and settings as text: the words of apps/web/PROTOCOL.md.

#include <string>

#include <nendo/flow/command.hpp>
#include <nendo/flow/loop_settings.hpp>

namespace nendo::commands {

/// Returns all settings, each once, separated by single spaces: "mode=type1 kernel=wendland-c2
/// ...". Allocates.
std::string text_of(const flow::LoopSettings& settings);

/// Returns the command as a client of the server would send it: "undo", "clutch left thumb off",
/// "settings mode=type2 ...". Commands that no client sends are "layer N on|off", "puppet N", "cut"
/// and, with its number, "copy part N" or "remove part N". Allocates.
std::string text_of(const flow::Command& command);

} // namespace nendo::commands
