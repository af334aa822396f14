#pragma once
// A recorded run becomes a timeline.

#include <filesystem>

#include <nendo/base/result.hpp>
#include <nendo/timeline/reduce.hpp>

namespace nendo::timeline {

struct MadeTimeline {
  Timeline timeline;
  std::vector<Reduction> hands; ///< by the timeline's hands, without their keys
  bool exact = false;           ///< nothing was missing in the recording
};

/// Runs the recorded loop over `model`, which ought to be the one that was recorded, and takes its
/// hands' angles and what became of its model: a switch's doing is an event as a request is. The
/// key at 0 s is the pose in which a hand took hold, a period before the first tick. Blocks.
/// Errors: bad_input (as TakeReader::open(), LoopReplay::make(); no tick; more than `most` frames
/// or events).
Result<MadeTimeline> timeline_of_take(const std::filesystem::path& take, const deform::Mesh& model,
                                      const Tolerance& tolerance, std::size_t most = most_keys);
static_assert(most_keys == most_events);

} // namespace nendo::timeline
