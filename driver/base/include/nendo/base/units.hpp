#pragma once
// Units in interfaces between modules. All are SI: metres, radians, seconds. Plain numbers carry
// their unit in the name (`angle_rad`, `rate_hz`), times are std::chrono, and raw sensor counts
// have a type of their own.

#include <chrono>
#include <compare>
#include <cstdint>
#include <numbers>

#include <nendo/base/api.hpp>

namespace nendo {

/// An uncalibrated sensor reading, as sent by the glove. 8-bit gloves send 1..255.
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

/// Returns the duration, truncated to whole nanoseconds. Values out of range saturate to the
/// longest or shortest duration, and NaN gives zero.
constexpr HostClock::duration from_seconds(double seconds) noexcept {
  constexpr double max_s = to_seconds(HostClock::duration::max());
  if (seconds != seconds) return HostClock::duration::zero();
  if (seconds >= max_s) return HostClock::duration::max();
  if (seconds <= -max_s) return HostClock::duration::min();
  return std::chrono::duration_cast<HostClock::duration>(std::chrono::duration<double>(seconds));
}

constexpr double to_milliseconds(std::chrono::nanoseconds d) noexcept {
  return static_cast<double>(d.count()) / 1e6;
}

constexpr double to_microseconds(std::chrono::nanoseconds d) noexcept {
  return static_cast<double>(d.count()) / 1e3;
}

/// Returns the seconds from one time to another. Defined for any two times: an overflowing
/// difference wraps around.
constexpr double seconds_between(HostTime from, HostTime to) noexcept {
  const auto ticks = [](HostTime time) {
    return static_cast<std::uint64_t>(time.time_since_epoch().count());
  };
  return to_seconds(HostClock::duration(static_cast<HostClock::rep>(ticks(to) - ticks(from))));
}

/// Degrees are only for user interfaces (strings, options) and for tables from publications.
constexpr double from_degrees(double angle_deg) noexcept {
  return angle_deg * std::numbers::pi / 180.0;
}
constexpr double to_degrees(double angle_rad) noexcept {
  return angle_rad * 180.0 / std::numbers::pi;
}

} // namespace nendo
