#include "cyberglove/cyberglove_period.hpp"

#include <cmath>
#include <limits>

#include "cyberglove/cyberglove_protocol.hpp"

namespace nendo::driver::cyberglove {

double rate_of(Period period) noexcept {
  if (period.ticks == 0 || period.times == 0) return 0.0;
  return clock_hz / (static_cast<double>(period.ticks) * period.times);
}

std::optional<Period> choose_period(double rate_hz) noexcept {
  constexpr double most = std::numeric_limits<std::uint16_t>::max();
  if (!(rate_hz > 0.0 && rate_hz <= clock_hz)) return std::nullopt;
  const double ticks = clock_hz / rate_hz;
  if (!(ticks <= most * most)) return std::nullopt;
  // As few repetitions as possible: the words then come nearest.
  const double times = std::ceil(std::round(ticks) / most);
  return Period{static_cast<std::uint16_t>(std::round(ticks / times)),
                static_cast<std::uint16_t>(times)};
}

Period decode_period(PeriodBytes bytes, WordOrder order) noexcept {
  const auto word = [&](std::size_t at) {
    const auto first = std::to_integer<unsigned>(bytes[at]);
    const auto second = std::to_integer<unsigned>(bytes[at + 1]);
    return static_cast<std::uint16_t>(order == WordOrder::high_first ? first << 8U | second
                                                                     : second << 8U | first);
  };
  return {word(0), word(2)};
}

std::optional<WordOrder> order_of(PeriodBytes bytes, Period period) noexcept {
  for (const WordOrder order : {WordOrder::high_first, WordOrder::low_first}) {
    if (decode_period(bytes, order) == period) return order;
  }
  return std::nullopt;
}

std::optional<Period> guess_period(PeriodBytes bytes) noexcept {
  constexpr double max_hz = 1000.0;
  std::optional<Period> best;
  for (const WordOrder order : {WordOrder::high_first, WordOrder::low_first}) {
    const Period period = decode_period(bytes, order);
    const double rate_hz = rate_of(period);
    if (rate_hz > max_hz) continue;
    // Where a low byte is 0, both orders have the same rate: 1280 times 1 is 5 times 256.
    const bool better = !best || rate_hz > rate_of(*best) ||
                        (rate_hz == rate_of(*best) && period.times < best->times);
    if (better) best = period;
  }
  return best;
}

} // namespace nendo::driver::cyberglove
