#pragma once
// Runs a stress test, from the description of the machine to the last tick.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/record_counts.hpp>

#include "session/run_session.hpp"
#include "stress/changes.hpp"
#include "stress/environment.hpp"
#include "stress/stress_options.hpp"
#include "stress/tick_tally.hpp"

namespace nendo::stress {

/// The resources that the loop's thread used, without its set-up.
struct ThreadCosts {
  long minor_faults = 0;
  long major_faults = 0;
  long voluntary_switches = 0;
  long involuntary_switches = 0;
  double cpu_s = 0.0;
};

struct StressOutcome {
  explicit StressOutcome(const flow::PaceOptions& pace) : tally(pace) {}

  Environment environment;
  std::vector<flow::Grant> grants;
  PlatformFloor floor;
  TickTally tally;
  std::uint64_t overruns = 0;
  std::uint64_t missed = 0;
  std::uint64_t failed = 0;          ///< ticks without a usable field
  std::uint64_t records_refused = 0; ///< ticks whose record found the ring full: not in `tally`
  ThreadCosts costs;
  std::optional<ChangeTallies> by_changes; ///< if settings were changed
  std::uint64_t changes = 0;               ///< of settings, that the loop has taken
  std::optional<double> stolen_s;
  double elapsed_s = 0.0;
  Eigen::Index vertices = 0;
  std::vector<std::string> gloves;                  ///< GloveInfo::source of each
  std::vector<driver::RecordCounts> glove_records;  ///< of each, since it was started
  std::uint64_t pictures = 0;                       ///< that the observer made of the loop
  std::chrono::system_clock::time_point wall_start; ///< `start` by the system clock
  HostTime start{};
  bool spins = false;   ///< the spin tail was asked for, and SCHED_FIFO granted
  bool broke = false;   ///< --break ended it
  bool stopped = false; ///< a signal ended it
};

/// Called about four times a second.
using StressProgress = std::function<void(const TickTally& tally, double elapsed_s)>;

/// Measures the floor, starts the load, and runs the loop for its time, until a stop signal, or
/// until a tick is later than `break_at`. An observer watches as it does in a run, but only
/// commands to the loop, settings and the end are obeyed; it gets a report of any other. Blocks.
/// Errors: those of open_hands(), place_loop() and Load::start().
Result<std::unique_ptr<StressOutcome>> run_stress(StressOptions options, const deform::Mesh& model,
                                                  const StressProgress& progress,
                                                  session::Observer* observer = nullptr);

} // namespace nendo::stress
