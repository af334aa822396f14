#pragma once
// Measures how long a record takes from the write of its last byte at the device's end until its
// sample is visible in the ring. It measures the real CyberGlove driver and, as the lower bound for
// any program, a thread that calls poll() and read() and pushes. Both run at once and take records
// in turn, because a machine's speed changes between two runs.

#include <atomic>
#include <cstddef>
#include <functional>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>

namespace nendo::bench {

enum class Line {
  pseudo_terminal, ///< what an emulated glove has; its far end is a kernel worker of no priority
  socket_pair,     ///< without a kernel worker, so that the driver's own latency remains
};

struct LatencyOptions {
  Line line = Line::pseudo_terminal;
  std::size_t records = 2000; ///< number of records per path
  double rate_hz = 300.0;     ///< 1 to 480, records per second to the driver; with stamps, 384 fit
};

/// Each sink receives the latency of every record.
struct LatencySinks {
  std::function<void(HostClock::duration)> driver; ///< the CyberGlove driver's
  std::function<void(HostClock::duration)> bare; ///< those of the thread that only polls and reads
};

/// Measures until done or until `stop` becomes true. Blocks for records / rate_hz plus about 2 s.
/// The sinks are called from another thread, one at a time. Errors: failed (no line, or a record
/// did not arrive within a second), usage.
Result<void> measure_latency(const LatencyOptions& options, const LatencySinks& sinks,
                             const std::atomic<bool>& stop);

} // namespace nendo::bench
