#pragma once
// Runs from open gloves to a shape. The loop has a thread of its own. The main thread watches it,
// takes commands, and makes a new loop for commands that need one.

#include <functional>
#include <string>
#include <vector>

#include "session/observer.hpp"
#include "session/run_options.hpp"
#include "session/run_publishing.hpp"

namespace nendo::session {

/// The result of a run, of which the summary is made.
struct RunOutcome {
  flow::LoopStats stats;
  double elapsed_s = 0.0;
  Eigen::Index vertices = 0;
  double radius = 0.0; ///< the largest
  std::string result;
  std::vector<flow::Grant> grants;
  std::vector<RecordingOutcome> recordings; ///< one a loop
  std::vector<PublishedTo> published{};     ///< added by whoever owns the sinks
  /// The last loop's, after all changes of settings.
  flow::SculptorOptions sculptor{};
};

/// Returns how many deadlines of the grid a run lasts. The number is unlimited if only the clock
/// says when the run is over.
std::uint64_t ticks_for(const RunOptions& options) noexcept;
/// Tells whether a run that began at `start` has lasted its duration, by the clock.
bool is_over(const RunOptions& options, HostTime start) noexcept;

/// Called about four times a second with the latest frame.
using Progress = std::function<void(const flow::Frame& frame, double elapsed_s)>;

/// The participants of a run besides its loop. They must outlive the run.
struct RunParticipants {
  Progress progress; ///< always there
  /// The observers. If two of them ask for different things, the later one in the list wins.
  std::vector<Observer*> observers{};
  std::vector<Sink*> sinks{};
};

/// Runs until the duration is over, a stop signal comes, a command asks for the end, or all gloves
/// have ended (unless an observer stays open), and then writes the shape. The keys (run_keys.hpp)
/// observe every run. Prints on standard error which rights were refused. `grants` are the rights
/// that were asked for before, for the process and the readers.
///
/// For a command that a running loop cannot obey (loop_change.hpp), the loop is ended and another
/// one is made, at most four times a second. It goes on from the present shape and poses, with the
/// hands where they were and what --adapt has learned of them. If no loop can be made with the
/// change, standard error says so, and the run goes on without the change. Each recorded loop has a
/// file of its own. Returns the last loop's outcome, with every recording. Blocks.
Result<RunOutcome> run_session(RunOptions options, std::vector<gloves::OpenHand>& hands,
                               deform::Mesh model, const RunParticipants& participants,
                               std::vector<flow::Grant> grants = {});

} // namespace nendo::session
