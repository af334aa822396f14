#pragma once
// From a device's own clock to the host's. Pure: no I/O, clock, log or allocation. One thread.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo::driver {

/// A clock of 115200 ticks a second that wraps after 2^32 (10.36 h) becomes one that does not. A
/// smaller value than the one before is a wrap: records cannot overtake each other.
class TickUnwrapper {
public:
  /// Since the device's own zero, rounded down to a nanosecond: 9 ticks are 78125 ns, so nothing
  /// adds up over the years. A silence of more than one wrap cannot be seen.
  std::chrono::nanoseconds unwrap(std::uint32_t ticks) noexcept;
  /// The device's clock began anew.
  void reset() noexcept { total_ticks_ = 0; }

private:
  std::uint64_t total_ticks_ = 0; ///< its lower half is the value before
};

/// When did the device take a record? It arrives late by a delay that is never negative, mostly
/// short and sometimes very long: transmission, latency timers, scheduling, stalls. So the relation
/// of the two clocks is read off the records that came soonest: (arrival - device time) is bounded
/// below by a straight line, whose slope is the drift. The line is the one below all points that
/// comes closest to them on average, an edge of their lower convex hull (S. B. Moon, P. Skelly,
/// D. Towsley, "Estimation and removal of clock skew from network delay measurements", 1999), over
/// the minima of the last 64 seconds. The shortest delay itself cannot be seen: it is in the
/// result.
///
/// A device whose clock falls behind for good is followed after 64 s, all else at once or nearly.
class DeviceClock {
public:
  /// Never later than `arrival`. Not before the last result either, while arrivals do not run
  /// back. A device time that runs back, or is 10 s or more from where it should be, is taken for a
  /// new clock. Times beyond 73 years are absurd: `arrival`, and nothing learnt.
  HostTime to_host(std::chrono::nanoseconds device_time, HostTime arrival) noexcept;
  /// The device's clock began anew.
  void reset() noexcept;
  /// By how much the device's clock is fast, of a million; 0 for the first 4 s. At most 500.
  double drift_ppm() const noexcept;

private:
  using Nanoseconds = std::int64_t;
  /// The record of a block that came soonest.
  struct Point {
    Nanoseconds device = 0;
    Nanoseconds offset = 0; ///< arrival - device
  };
  static constexpr std::size_t most_blocks = 64;

  void add(const Point& point) noexcept;
  void fit() noexcept;
  double hull_slope() const noexcept;
  const Point& block(std::size_t k) const noexcept { return blocks_[(oldest_ + k) % most_blocks]; }
  double line_at(Nanoseconds device) const noexcept;

  std::array<Point, most_blocks> blocks_{}; ///< a ring; the last one is not yet complete
  std::size_t oldest_ = 0;
  std::size_t count_ = 0;
  Nanoseconds block_begin_ = 0; ///< of the last one, in device time
  Nanoseconds last_device_ = 0;
  Nanoseconds last_result_ = 0;
  // offset = base_.offset + intercept_ + slope_ * (device - base_.device)
  Point base_;
  double intercept_ = 0.0;
  double slope_ = 0.0;
};

} // namespace nendo::driver
