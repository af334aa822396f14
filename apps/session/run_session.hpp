#pragma once
// A run from open gloves to a shape. The loop runs on a thread of its own; the main thread watches
// it, takes commands and makes a new loop where they need one.

#include <functional>
#include <string>
#include <vector>

#include "session/observer.hpp"
#include "session/run_options.hpp"
#include "session/run_publishing.hpp"

namespace nendo::session {

/// What the summary is made of.
struct RunOutcome {
  flow::LoopStats stats;
  double elapsed_s = 0.0;
  Eigen::Index vertices = 0;
  double radius = 0.0; ///< the largest
  std::string result;
  std::vector<flow::Grant> grants;
  std::vector<RecordingOutcome> recordings; ///< one a loop
  std::vector<PublishedTo> published{};     ///< added by whoever owns the sinks
};

/// How many deadlines of the grid a run lasts; no end where the clock alone says when it is over.
std::uint64_t ticks_for(const RunOptions& options) noexcept;
/// Whether a run that began at `start` has lasted its duration, by the clock.
bool is_over(const RunOptions& options, HostTime start) noexcept;

/// Called about four times a second with the latest frame.
using Progress = std::function<void(const flow::Frame& frame, double elapsed_s)>;

/// Who takes part in a run besides its loop. All must outlive it.
struct RunParticipants {
  Progress progress; ///< always there
  /// What the last one asks for counts, where two ask for different things.
  std::vector<Observer*> observers{};
  std::vector<Sink*> sinks{};
};

/// Runs until the duration is over, a stop signal comes or somebody asks for the end, then writes
/// the shape. The keys (run_keys.hpp) are an observer of every run. Says on standard error which
/// rights were refused. `grants` is what was asked for before, of the process and the readers.
///
/// For a command that a running loop cannot obey (loop_change.hpp) the loop is ended and another
/// one made, which goes on from the shape and the poses as they are, with the hands where they were
/// and what --adapt has learned of them; that happens four times a second at most. If no loop can
/// be made with the change, standard error says so, and the run goes on without it. Each loop that
/// is recorded has a file of its own. The outcome is the last loop's, with every recording. Blocks.
Result<RunOutcome> run_session(RunOptions options, std::vector<gloves::OpenHand>& hands,
                               deform::Mesh model, const RunParticipants& participants,
                               std::vector<flow::Grant> grants = {});

} // namespace nendo::session
