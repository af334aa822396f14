#pragma once
// Runs a stress test, from the description of the machine and its latency floor to the last tick.

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/histogram.hpp>
#include <nendo/flow/realtime.hpp>

#include "session/observer.hpp"
#include "stress/stress_options.hpp"
#include "stress/tick_tally.hpp"

namespace nendo::stress {

struct Environment {
  std::string kernel;      ///< "6.1.0-18-amd64"
  std::string preemption;  ///< "PREEMPT_RT", "PREEMPT_DYNAMIC", "" if the kernel does not say
  std::string processor;   ///< its model name
  unsigned cpus = 0;       ///< online
  bool hypervisor = false; ///< the processor says that it is a virtual one
  std::string governor;    ///< the governor of the first CPU's frequency; empty if there is none
  std::string clock_source;
  std::optional<long> rt_runtime_us; ///< real-time threads' share of each second; -1: no limit
};

/// Reads /proc and /sys. Values that the system does not provide stay empty.
Environment describe_environment();

/// Returns the stolen time since boot, summed over all CPUs: the time that the host gave to others
/// while this virtual machine was ready to run. Returns nothing if the kernel does not count it. It
/// is counted in ticks of 10 ms, so short gaps are not included.
std::optional<double> stolen_s();

/// The latency floor of this machine: the gaps that a thread sees that only reads the clock. No
/// program can be better.
struct PlatformFloor {
  /// The times between two readings of the clock that are longer than a microsecond.
  flow::Histogram gaps;
  double spun_s = 0.0;    ///< the duration of the measurement
  double stalled_s = 0.0; ///< the sum of `gaps`
};

/// Reads the clock for that time on a thread with the rights of the loop's thread. It spins
/// in short turns, because the kernel stops real-time threads that use 95 % of a second. Ends early
/// when `stop` is set. Blocks.
PlatformFloor measure_floor(double seconds, const flow::RealtimeOptions& realtime,
                            const std::atomic<bool>& stop);

/// The resources that the loop's thread used, without its set-up.
struct ThreadCosts {
  long minor_faults = 0;
  long major_faults = 0;
  long voluntary_switches = 0;
  long involuntary_switches = 0;
  double cpu_s = 0.0;
};

/// What changes of settings cost a loop: with --changes the radius of all fingers changes in every
/// other second, and the ticks of both kinds of seconds are counted apart. Both are of one run, so
/// that other work of the machine affects both.
struct ChangeTally {
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0; ///< deadlines before these ticks
  flow::Histogram lateness;
  flow::Histogram work;
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
  std::uint64_t records_refused = 0; ///< ticks that are not in `tally`, because the ring was full
  ThreadCosts costs;
  std::optional<std::array<ChangeTally, 2>> by_changes; ///< seconds without changes, and with
  std::uint64_t changes = 0; ///< changes of settings, that the loop has taken
  std::optional<double> stolen_s;
  double elapsed_s = 0.0;
  Eigen::Index vertices = 0;
  std::vector<std::string> gloves;                  ///< GloveInfo::source of each
  std::vector<driver::RecordCounts> glove_records;  ///< each glove's counts since its start
  std::uint64_t pictures = 0;                       ///< that the observer made of the loop
  std::chrono::system_clock::time_point wall_start; ///< `start` by the system clock
  HostTime start{};
  bool spins = false;   ///< the spin tail was requested, and SCHED_FIFO granted
  bool broke = false;   ///< --break ended it
  bool stopped = false; ///< a signal ended it
};

/// Called about four times a second.
using StressProgress = std::function<void(const TickTally& tally, double elapsed_s)>;

/// Measures the floor, starts the load, and runs the loop for its time, until a stop signal, or
/// until a tick is later than `break_at`. An observer watches as it does in a run, but only
/// commands to the loop, settings and the end are executed; it gets a report of any other. Blocks.
/// Errors: those of open_hands(), place_loop() and Load::start().
Result<std::unique_ptr<StressOutcome>> run_stress(StressOptions options, const deform::Mesh& model,
                                                  const StressProgress& progress,
                                                  session::Observer* observer = nullptr);

} // namespace nendo::stress
