#pragma once
// Units that cross folder boundaries. SI everywhere: metres, radians, seconds; bare numbers carry
// their unit in the name (`angle_rad`, `rate_hz`), time is std::chrono, and raw sensor counts are a
// type of their own.

#include <chrono>
#include <compare>
#include <cstdint>
#include <numbers>

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

/// Returns the longest duration, or the shortest, for seconds that HostClock cannot count, and zero
/// for what is not a number. Parts of a nanosecond are cut off.
constexpr HostClock::duration from_seconds(double seconds) noexcept {
  constexpr double most_s = to_seconds(HostClock::duration::max());
  if (seconds != seconds) return HostClock::duration::zero();
  if (seconds >= most_s) return HostClock::duration::max();
  if (seconds <= -most_s) return HostClock::duration::min();
  return std::chrono::duration_cast<HostClock::duration>(std::chrono::duration<double>(seconds));
}

constexpr double to_milliseconds(std::chrono::nanoseconds d) noexcept {
  return static_cast<double>(d.count()) / 1e6;
}

constexpr double to_microseconds(std::chrono::nanoseconds d) noexcept {
  return static_cast<double>(d.count()) / 1e3;
}

/// Defined for any two times: far apart, where their difference would overflow, it wraps instead.
constexpr double seconds_between(HostTime from, HostTime to) noexcept {
  const auto ticks = [](HostTime time) {
    return static_cast<std::uint64_t>(time.time_since_epoch().count());
  };
  return to_seconds(HostClock::duration(static_cast<HostClock::rep>(ticks(to) - ticks(from))));
}

/// Degrees are for people: texts, tables of sources, options. Radians of degrees, and back.
constexpr double from_degrees(double angle_deg) noexcept {
  return angle_deg * std::numbers::pi / 180.0;
}
constexpr double to_degrees(double angle_rad) noexcept {
  return angle_rad * 180.0 / std::numbers::pi;
}

} // namespace nendo
