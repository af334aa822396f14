#pragma once
// The time between two records of a stream, as the unit counts it: `ticks` of 1/115200 s, `times`
// over [p.47]. Pure.

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

/// Records a second; 0 if either word is 0, which means as fast as the glove can.
double rate_of(Period period) noexcept;

/// The period next to 1/rate_hz: exact to half a tick above 1.76 Hz, to `times` / 2 ticks below.
/// Returns nullopt above 115200 Hz, below one record in ten hours, and for NaN.
std::optional<Period> choose_period(double rate_hz) noexcept;

/// Which byte of a word comes first in the reply to ?T. Sources contradict each other: the authors
/// who had the manual, and the unit's processor, say high; the vendor's library writes other words
/// low first.
enum class WordOrder : std::uint8_t { high_first, low_first };

using PeriodBytes = std::span<const std::byte, 4>;

Period decode_period(PeriodBytes bytes, WordOrder order) noexcept;

/// The order in which `bytes` say `period`; nothing if they say something else.
std::optional<WordOrder> order_of(PeriodBytes bytes, Period period) noexcept;

/// For a unit whose order is unknown. The wrong one mostly yields an absurdly slow rate, so the
/// faster of those up to 1000 Hz is taken, and of two alike the one that repeats less; nothing if
/// both are faster.
std::optional<Period> guess_period(PeriodBytes bytes) noexcept;

} // namespace nendo::driver::cyberglove
