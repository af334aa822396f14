#pragma once
// Runs from open gloves to a shape, and reports. The loop has a thread of its own. The main thread
// watches it, takes commands, and makes ready what they need.

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
  double radius = 0.0; ///< the largest, at the end
  std::string result;
  std::vector<flow::Grant> grants;
  std::vector<RecordingOutcome> recordings;
  std::vector<PublishedTo> published{}; ///< added by the owner of the sinks
  /// After all changes of settings.
  flow::SculptorOptions sculptor{};
  double units_per_metre = 1.0; ///< from the stage to the model
};

/// Returns how many deadlines of the grid a run lasts. The number is unlimited if only the clock
/// says when the run is over.
std::uint64_t ticks_for(const RunOptions& options) noexcept;
/// Returns whether a run that began at `start` has lasted its duration, by the clock.
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
/// have ended (unless an observer stays open), and then writes the shape. The terminal's keys
/// observe every run. Prints on standard error which rights were refused. `grants` are the rights
/// that were asked for before, for the process and the readers.
///
/// Simulated hands and recordings of gloves begin when the loop does (gloves::begin_again()).
/// The loop takes all commands without a pause. What a change of settings needs is made on the main
/// thread beforehand. If a command cannot be executed, the observers get a message, and the run
/// continues. Blocks.
Result<RunOutcome> run_session(RunOptions options, std::vector<gloves::OpenHand>& hands,
                               deform::Mesh model, const RunParticipants& participants,
                               std::vector<flow::Grant> grants = {});

/// Returns the function that reports the progress of a run with these hands. In a terminal it
/// rewrites one line of standard error, and elsewhere it prints a line every two seconds. With
/// `options.json` it prints an object a second on standard output.
Progress progress_for(const RunOptions& options, const std::vector<gloves::OpenHand>& hands);
/// Prints the summary on standard output: a table, or with `options.json` one object.
void print_summary(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                   const RunOutcome& outcome);
/// The JSON forms of both. Each prints one line on standard output.
void print_progress_json(const flow::Frame& frame, double elapsed_s);
void print_summary_json(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome);

} // namespace nendo::session
