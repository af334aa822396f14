#pragma once
// The commands of nendo-markers.

#include "cli/command.hpp"

namespace nendo::markers {

inline constexpr const char* program_summary =
    "nendo-markers: tracks printed bracelets by a camera, and sends where the wrists are to a run "
    "of nendo.";

/// Adds print, calibrate and track.
void add_commands(cli::Command& program);

} // namespace nendo::markers
