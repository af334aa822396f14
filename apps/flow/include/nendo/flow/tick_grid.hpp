#pragma once
// The times at which a fixed-rate loop runs: tick k is due at start + k / rate. That is computed
// from the start each time, so that rounding errors never add up to drift, also where the period is
// no whole number of nanoseconds (90 Hz).

#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo::flow {

class NENDO_API TickGrid {
public:
  static constexpr double min_rate_hz = 1.0;
  static constexpr double max_rate_hz = 10'000.0;

  /// The rate is kept to a thousandth of a hertz. Asserts that it is within the limits.
  TickGrid(HostTime start, double rate_hz) noexcept;

  HostTime deadline(std::uint64_t tick) const noexcept;
  /// Returns the first tick that is due later than `now`.
  std::uint64_t first_after(HostTime now) const noexcept;

private:
  HostTime start_;
  std::uint64_t rate_mhz_; ///< thousandths of a hertz
};

/// Sleeps until an absolute time, and continues sleeping after a signal. This is the only system
/// call of a tick.
NENDO_API void sleep_until(HostTime deadline) noexcept;

} // namespace nendo::flow
