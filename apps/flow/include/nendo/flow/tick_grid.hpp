#pragma once
// The times at which a fixed-rate loop runs: tick k is due at start + k / rate, computed from the
// start each time, so that rounding never adds up to drift, at 90 Hz (11.1... ms) as at 100.

#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo::flow {

class TickGrid {
public:
  static constexpr double least_rate_hz = 1.0;
  static constexpr double most_rate_hz = 10'000.0;

  /// The rate is kept to a thousandth of a hertz. Asserts that it is within the limits.
  TickGrid(HostTime start, double rate_hz) noexcept;

  HostTime deadline(std::uint64_t tick) const noexcept;
  /// The first tick that is due later than `now`.
  std::uint64_t first_after(HostTime now) const noexcept;

private:
  HostTime start_;
  std::uint64_t rate_mhz_; ///< thousandths of a hertz
};

/// Sleeps until an absolute time; also after signals. The one system call of a tick.
void sleep_until(HostTime deadline) noexcept;

} // namespace nendo::flow
