#pragma once
// Runs a session from open gloves to the written shape, and reports. The loop has its own thread.
// The main thread observes it, takes commands, and prepares changes.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "session/observer.hpp"
#include "session/run_options.hpp"
#include "session/run_publishing.hpp"

namespace nendo::session {

/// The result of a run, for its summary.
struct RunOutcome {
  flow::LoopStats stats;
  double elapsed_s = 0.0;
  Eigen::Index vertices = 0;
  double radius = 0.0; ///< the largest radius at the end
  std::string result;
  std::vector<flow::Grant> grants;
  std::vector<RecordingOutcome> recordings;
  std::vector<PublishedTo> published{}; ///< set by the owner of the sinks
  /// The options after all changes of settings.
  flow::SculptorOptions sculptor{};
  double units_per_metre = 1.0; ///< model units per metre of the stage
  std::optional<viewer::PictureTimes> pictures{};
};

/// Returns the number of a run's deadlines on the grid; unlimited if the run ends by the clock.
std::uint64_t ticks_for(const RunOptions& options) noexcept;
/// Returns whether a run that began at `start` has reached its duration, by the clock.
bool is_over(const RunOptions& options, HostTime start) noexcept;

/// Called about four times per second with the latest frame.
using Progress = std::function<void(const flow::Frame& frame, double elapsed_s)>;

/// The participants of a run besides its loop. They must outlive the run.
struct RunParticipants {
  Progress progress; ///< must not be empty
  /// The observers. If requests of two observers conflict, the later one in the list wins.
  std::vector<Observer*> observers{};
  std::vector<Sink*> sinks{};
};

/// Runs until the duration is over, a stop signal, an EndRun, or the end of all gloves (unless an
/// observer stays open), and then writes the shape. The terminal's keys also observe each run.
/// Prints refused rights on standard error. `grants` are the results of earlier requests, for the
/// process and the readers.
///
/// Simulated hands and recordings of gloves begin with the loop (gloves::begin_again()). The main
/// thread prepares changes of settings, so that no command interrupts the loop. If a command cannot
/// be executed, the observers get a message, and the run continues. Blocks.
Result<RunOutcome> run_session(RunOptions options, std::vector<gloves::OpenHand>& hands,
                               deform::Mesh model, const RunParticipants& participants,
                               std::vector<flow::Grant> grants = {});

/// Returns whether the hand's tracker moved its wrist.
bool is_moved(const gloves::OpenHand& hand, const flow::LoopStats& stats) noexcept;
/// Returns the function that reports the progress of a run with these hands. In a terminal it
/// rewrites one line of standard error, and elsewhere it prints a line every two seconds. With
/// `options.json` it prints one object per second on standard output.
Progress progress_for(const RunOptions& options, const std::vector<gloves::OpenHand>& hands);
/// Prints the summary on standard output: a table, or with `options.json` one object.
void print_summary(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                   const RunOutcome& outcome);
/// The JSON forms of both. Each prints one line on standard output.
void print_progress_json(const flow::Frame& frame, double elapsed_s);
void print_summary_json(const RunOptions& options, const std::vector<gloves::OpenHand>& hands,
                        const RunOutcome& outcome);

} // namespace nendo::session
