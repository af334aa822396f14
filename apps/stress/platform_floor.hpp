#pragma once
// What no program on this machine can be better than: the gaps that a thread sees which does
// nothing but look at the clock.

#include <atomic>

#include <nendo/flow/histogram.hpp>
#include <nendo/flow/realtime.hpp>

namespace nendo::stress {

struct PlatformFloor {
  /// Between two looks at the clock, as far as longer than a microsecond.
  flow::Histogram gaps;
  double spun_s = 0.0;    ///< how long it looked
  double stalled_s = 0.0; ///< the sum of `gaps`
};

/// Spins for so long, on a thread of its own with the rights of the loop's, in short turns: the
/// kernel stops real-time threads that take 95 % of a second. Ends early when `stop` is set.
/// Blocks.
PlatformFloor measure_floor(double seconds, const flow::RealtimeOptions& realtime,
                            const std::atomic<bool>& stop);

} // namespace nendo::stress
