#pragma once
// The time between two records of a stream, as the unit counts it: `times` times `ticks` of
// 1/115200 s [p.47]. The functions are pure.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace nendo::driver::cyberglove {

struct Period {
  std::uint16_t ticks = 0;
  std::uint16_t times = 0;
  friend bool operator==(Period, Period) = default;
};

/// Returns the records a second, or 0 if either word is 0, which means as fast as the glove can.
double rate_of(Period period) noexcept;

/// Returns the period nearest to 1/rate_hz: exact to half a tick above 1.76 Hz, and to `times` / 2
/// ticks below. Returns nullopt above 115200 Hz, below one record in ten hours, and for NaN.
std::optional<Period> choose_period(double rate_hz) noexcept;

/// Which byte of a word comes first in the reply to ?T. Sources contradict each other: the authors
/// who had the manual, and the unit's processor, say high; the vendor's library writes other words
/// low first.
enum class WordOrder : std::uint8_t { high_first, low_first };

using PeriodBytes = std::span<const std::byte, 4>;

Period decode_period(PeriodBytes bytes, WordOrder order) noexcept;

/// Returns the byte order in which `bytes` mean `period`; nothing if they mean another one.
std::optional<WordOrder> order_of(PeriodBytes bytes, Period period) noexcept;

/// Returns the likely period of a unit whose byte order is unknown. The wrong order mostly yields a
/// very slow rate, so the faster rate up to 1000 Hz is taken and, of two equal rates, the period
/// with the smaller `times`. Returns nothing if both are faster.
std::optional<Period> guess_period(PeriodBytes bytes) noexcept;

} // namespace nendo::driver::cyberglove
