#pragma once
// Makes a timeline of a recorded run.

#include <filesystem>

#include <nendo/base/result.hpp>

#include "timeline/reduce.hpp"

namespace nendo::timeline {

struct MadeTimeline {
  Timeline timeline;
  std::vector<Reduction> hands; ///< in the order of the timeline's hands, without their keys
  bool exact = false;           ///< nothing was missing in the recording
  bool has_last_puppet = false; ///< the puppet was edited on the way; the timeline has the last one
};

/// Runs the recorded loop again over `model`, which should be the recorded one. The hands' angles
/// become keys; requests, what the wrist switch did, commands of a puppet, and marks become
/// events. The points of a puppet are off by the tolerance at most, by both hands together. The key
/// at 0 s is the pose in which a hand grabbed, one period before the first tick. Blocks. Errors:
/// those of TakeReader::open() and LoopReplay::make(); bad_input (no tick, or more than `most`
/// frames or events; a puppet that was begun on the way).
/// A timeline has one puppet. Where a take has several, because one was edited on the way, it is
/// the last one, from the beginning on. Functions that it has not are left out, and so are undos
/// and redos of edits.
Result<MadeTimeline> timeline_of_take(const std::filesystem::path& take, const deform::Mesh& model,
                                      const Tolerance& tolerance, std::size_t most = max_keys);
static_assert(max_keys == max_events);

} // namespace nendo::timeline
