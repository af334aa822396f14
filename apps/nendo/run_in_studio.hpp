#pragma once
// Runs in the studio's window, one after another.

#include <optional>

#include "nendo/run_arguments.hpp"
#include "studio/studio_timeline.hpp"

namespace nendo::app::run_command {

/// Opens the window with the run of these arguments or, with Begin::with_start, with the start, or
/// with a timeline. Continues until the user quits. Errors of the first run are printed, those of
/// later ones are shown in the window. Returns the exit code. Blocks.
int run_in_studio(const RunArguments& arguments,
                  std::optional<studio::FirstTimeline> timeline = {});

} // namespace nendo::app::run_command
