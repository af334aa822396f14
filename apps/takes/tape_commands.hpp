#pragma once
// The commands of a take, with their times.

#include <filesystem>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/flow/command.hpp>

#include "timeline/timeline.hpp"

namespace nendo::takes {

/// Returns the commands of a recording in their order, each with the time of the tick that took it,
/// since the recording began. Moves of wrists are left out, because they are in the poses. So are
/// settings and puppets that were already in effect, which recorders repeat, and entries that
/// follow from others: an undo's changes, and a cut, which follows "wire off". Blocks. Errors:
/// those of TakeReader::open().
Result<std::vector<timeline::Event>> recorded_commands(const std::filesystem::path& path);

} // namespace nendo::takes
