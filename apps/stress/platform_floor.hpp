#pragma once
// The latency floor of this machine: the gaps that a thread sees that only reads the clock. No
// program can be better.

#include <atomic>

#include <nendo/flow/histogram.hpp>
#include <nendo/flow/realtime.hpp>

namespace nendo::stress {

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
