#include "cyberglove/stamp_jitter.hpp"

namespace nendo::driver::cyberglove {
namespace {

/// Stamp and period come from one clock, so that a stamp errs by what keeps the firmware from
/// taking it at once: interrupts, and the conversion of a few channels. How much that is, no source
/// tells. A sixteenth of a period (0.6 ms at 100 Hz) is always allowed. Between two stamps that is
/// an eighth, into which a wrong stamp falls by chance in one of four cases.
constexpr std::uint32_t min_part = 8;
/// Where records were lost, a device that is known to be punctual is allowed less: a wrong bit that
/// fits makes the stamp some periods longer there, and all of them would be counted as missed.
constexpr std::uint32_t min_part_after_loss = 16;
/// Until the mean is known, a quarter of a period is allowed.
constexpr std::uint32_t unknown_part = 4;
/// A device whose stamps wander more is allowed five times its mean deviation: if stamps err evenly
/// to both sides, the largest one is three times the mean.
constexpr std::uint32_t times_mean = 5;
/// The mean is that of so many deviations. A single wrong stamp in it widens nothing.
constexpr std::uint32_t mean_steps = 16;
/// No single deviation counts for more, so that stamps are only taken to wander if more than half
/// of them do.
constexpr std::uint32_t max_counted_part = 4;
/// Beyond three eighths one cannot tell late from early. A mean of an eighth is a period that is
/// not kept closely.
constexpr std::uint32_t max_eighths = 3;
constexpr std::uint32_t hidden_part = 8;
constexpr std::uint32_t fraction = 256; ///< of a tick, in which deviations are summed

/// How far the gap is from a whole number of periods.
std::uint32_t deviation(std::uint32_t gap, std::uint32_t period) noexcept {
  const std::uint32_t whole = whole_periods(gap, period) * period;
  return gap > whole ? gap - whole : whole - gap;
}

} // namespace

std::uint64_t StampJitter::mean() const noexcept {
  return sum_ / (mean_steps * fraction);
}

void StampJitter::learn(std::uint32_t gap, std::uint32_t period) noexcept {
  const std::uint64_t now =
      std::uint64_t{fraction} * std::min(deviation(gap, period), period / max_counted_part);
  if (known_ == mean_steps) {
    sum_ = sum_ - sum_ / mean_steps + now;
    return;
  }
  // The mean of those there are, as if there were more of them.
  const std::uint64_t sum = sum_ * known_ / mean_steps + now;
  sum_ = sum * mean_steps / ++known_;
}

bool StampJitter::allows(std::uint32_t gap, std::uint32_t period) const noexcept {
  const std::uint32_t part = whole_periods(gap, period) != 1 ? min_part_after_loss
                             : known_ < mean_steps           ? unknown_part
                                                             : min_part;
  const std::uint64_t most = std::uint64_t{period} * max_eighths / 8;
  const std::uint64_t allowed =
      std::max<std::uint64_t>(period / part, std::min(most, times_mean * mean()));
  return deviation(gap, period) <= allowed;
}

bool StampJitter::hides(std::uint32_t period) const noexcept {
  return known_ == mean_steps && mean() > period / hidden_part;
}

} // namespace nendo::driver::cyberglove
