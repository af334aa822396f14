#pragma once
// Converts times of a device's own clock to the host's. It is pure (no I/O, clock, log or
// allocation) and belongs to one thread.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo::driver {

/// Makes a clock of 115200 ticks per second, which wraps after 2^32 ticks (10.36 h), into one that
/// does not wrap. A value smaller than the one before means a wrap, because records keep their
/// order.
class TickUnwrapper {
public:
  /// Returns the time since the device's own zero, rounded down to a nanosecond. Errors do not add
  /// up over the years, since 9 ticks are 78125 ns. A silence of more than one wrap cannot be
  /// noticed.
  std::chrono::nanoseconds unwrap(std::uint32_t ticks) noexcept;
  /// Starts again, because the device's clock began again.
  void reset() noexcept { total_ticks_ = 0; }

private:
  std::uint64_t total_ticks_ = 0; ///< its lower half is the value before
};

/// Estimates when the device took a record. A record arrives with a delay that is never negative,
/// mostly short and sometimes very long: transmission, latency timers, scheduling, stalls. So the
/// relation of the two clocks is taken from the records with the least delay: (arrival - device
/// time) is bounded below by a straight line, whose slope is the drift. Of all lines below the
/// points, it is the one that is closest to them on average, an edge of their lower convex hull (S.
/// B. Moon, P. Skelly, D. Towsley, "Estimation and removal of clock skew from network delay
/// measurements", 1999), over the minima of the last 64 seconds. The shortest delay itself cannot
/// be measured, so the result contains it.
///
/// If a device's clock falls behind for good, that is followed after 64 s; all other changes are
/// followed almost at once.
class DeviceClock {
public:
  /// Returns the host time, which is never later than `arrival`, and not before the last result
  /// while arrivals do not run back. A device time that runs back, or is 10 s or more off, is taken
  /// for a new clock. For times beyond 73 years, returns `arrival` and learns nothing.
  HostTime to_host(std::chrono::nanoseconds device_time, HostTime arrival) noexcept;
  /// Starts again, because the device's clock began again.
  void reset() noexcept;

private:
  using Nanoseconds = std::int64_t;
  /// The record of a block that came soonest.
  struct Point {
    Nanoseconds device = 0;
    Nanoseconds offset = 0; ///< arrival - device
  };
  static constexpr std::size_t max_blocks = 64;

  void add(const Point& point) noexcept;
  void fit() noexcept;
  double hull_slope() const noexcept;
  const Point& block(std::size_t k) const noexcept { return blocks_[(oldest_ + k) % max_blocks]; }
  double line_at(Nanoseconds device) const noexcept;

  std::array<Point, max_blocks> blocks_{}; ///< a ring; the last one is not yet complete
  std::size_t oldest_ = 0;
  std::size_t count_ = 0;
  Nanoseconds block_begin_ = 0; ///< begin of the last block, in device time
  Nanoseconds last_device_ = 0;
  Nanoseconds last_result_ = 0;
  // offset = base_.offset + intercept_ + slope_ * (device - base_.device)
  Point base_;
  double intercept_ = 0.0;
  double slope_ = 0.0;
};

} // namespace nendo::driver
