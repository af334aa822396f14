#pragma once
// The machine on which a measurement was taken: its description, the time that its host stole, and
// its latency floor.

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include <nendo/flow/histogram.hpp>
#include <nendo/flow/realtime.hpp>

namespace nendo::stress {

struct Environment {
  std::string kernel;      ///< "6.1.0-18-amd64"
  std::string preemption;  ///< "PREEMPT_RT", "PREEMPT_DYNAMIC", "" if the kernel does not say
  std::string processor;   ///< its model name
  unsigned cpus = 0;       ///< online
  bool hypervisor = false; ///< the processor says that it is a virtual one
  std::string governor;    ///< of the first CPU's frequency; empty if there is none
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

/// Reads the clock for that many seconds on a thread with the rights of the loop's thread. It spins
/// in short turns, because the kernel stops real-time threads that use 95 % of a second. Ends early
/// when `stop` is set. Blocks.
PlatformFloor measure_floor(double seconds, const flow::RealtimeOptions& realtime,
                            const std::atomic<bool>& stop);

} // namespace nendo::stress
