#pragma once
// Units that cross folder boundaries. SI everywhere: metres, radians, seconds; bare numbers carry
// their unit in the name (`angle_rad`, `rate_hz`), time is std::chrono, and raw sensor counts are a
// type of their own.

#include <chrono>
#include <compare>
#include <cstdint>

namespace nendo {

/// A sensor reading as the glove sent it, before calibration. 8-bit gloves send 1..255.
struct RawCount {
  std::uint16_t value = 0;
  friend constexpr auto operator<=>(RawCount, RawCount) = default;
};

/// Host time. On Linux this clock is CLOCK_MONOTONIC.
using HostClock = std::chrono::steady_clock;
using HostTime = HostClock::time_point;

constexpr double to_seconds(HostClock::duration d) noexcept {
  return std::chrono::duration<double>(d).count();
}

} // namespace nendo
