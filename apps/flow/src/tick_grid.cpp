#include <nendo/flow/tick_grid.hpp>

#include <cassert>
#include <cerrno>
#include <cmath>
#include <ctime>

namespace nendo::flow {

using std::chrono::nanoseconds;

TickGrid::TickGrid(HostTime start, double rate_hz) noexcept
    : start_(start), rate_mhz_(static_cast<std::uint64_t>(std::llround(rate_hz * 1000.0))) {
  assert(rate_hz >= min_rate_hz && rate_hz <= max_rate_hz);
}

HostTime TickGrid::deadline(std::uint64_t tick) const noexcept {
  // tick * 10^12 / rate_mhz nanoseconds, split so that no product leaves 64 bits: the remainder is
  // below 10^7.
  constexpr std::uint64_t tera = 1'000'000'000'000;
  const std::uint64_t whole = tick / rate_mhz_ * tera;
  const std::uint64_t part = tick % rate_mhz_ * tera / rate_mhz_;
  return start_ + nanoseconds(static_cast<nanoseconds::rep>(whole + part));
}

std::uint64_t TickGrid::first_after(HostTime now) const noexcept {
  if (now < start_) return 0;
  const double elapsed_s = to_seconds(now - start_);
  auto tick = static_cast<std::uint64_t>(elapsed_s * static_cast<double>(rate_mhz_) / 1000.0);
  // The estimate can be off by a tick through rounding; the deadlines decide.
  while (tick > 0 && deadline(tick - 1) > now)
    --tick;
  while (deadline(tick) <= now)
    ++tick;
  return tick;
}

void sleep_until(HostTime deadline) noexcept {
  const auto since_epoch = deadline.time_since_epoch();
  const auto whole = std::chrono::floor<std::chrono::seconds>(since_epoch);
  timespec at{};
  at.tv_sec = static_cast<std::time_t>(whole.count());
  at.tv_nsec = static_cast<long>(nanoseconds(since_epoch - whole).count());
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr) == EINTR) {
  }
}

} // namespace nendo::flow
