#include <nendo/flow/spin_margin.hpp>

#include <algorithm>

namespace nendo::flow {

using std::chrono::microseconds;

SpinMargin::SpinMargin(HostClock::duration period) noexcept
    : period_(period), cap_(std::min<HostClock::duration>(most, period / 5)),
      margin_(std::min(cap_, period / max_of_period)),
      ticks_in_a_second_(static_cast<std::uint32_t>(
          std::max<HostClock::rep>(1, std::chrono::seconds(1) / period))) {}

void SpinMargin::observe(HostClock::duration lateness) noexcept {
  const auto us = std::clamp<microseconds::rep>(
      std::chrono::duration_cast<microseconds>(lateness).count(), 0, most.count());
  ++counts_[static_cast<std::size_t>(us)];
  if (++seen_ == ticks_in_a_second_) adapt();
}

microseconds SpinMargin::needed() const noexcept {
  const std::uint32_t may_be_later = seen_ / 1000;
  std::size_t at = counts_.size() - 1;
  for (std::uint32_t later = counts_[at]; at > 0 && later <= may_be_later; later += counts_[at])
    --at;
  // A bucket begins at its whole microseconds and ends one further on.
  return microseconds(static_cast<microseconds::rep>(at) + 1) + reserve;
}

// With a margin that is a microsecond longer, each wake-up that is no later than that spins for a
// microsecond more.
microseconds SpinMargin::affordable() const noexcept {
  const auto budget_us = static_cast<std::uint64_t>(
      std::chrono::duration_cast<microseconds>(seen_ * (period_ / max_of_period)).count());
  std::uint64_t spun_us = 0;
  std::uint64_t in_time = 0;
  microseconds::rep margin_us = 0;
  for (; margin_us < most.count(); ++margin_us) {
    in_time += counts_[static_cast<std::size_t>(margin_us)];
    spun_us += in_time;
    if (spun_us > budget_us) break;
  }
  return microseconds(margin_us);
}

void SpinMargin::adapt() noexcept {
  margin_ = std::min<HostClock::duration>(cap_, std::min(needed(), affordable()));
  counts_.fill(0);
  seen_ = 0;
}

} // namespace nendo::flow
