#include <nendo/flow/pacer.hpp>

#include <cassert>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <utility>

#include <nendo/base/atomics.hpp>
#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

namespace nendo::flow {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

namespace {

constexpr std::array<std::string_view, 4> policy_names{"skip", "catch-up", "re-anchor", "sample"};
constexpr unsigned max_burst = 1000;

} // namespace

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

SpinMargin::SpinMargin(HostClock::duration period) noexcept
    : period_(period), cap_(std::min<HostClock::duration>(most, period / 5)),
      margin_(std::min(cap_, period / max_of_period)),
      ticks_per_second_(static_cast<std::uint32_t>(
          std::max<HostClock::rep>(1, std::chrono::seconds(1) / period))) {}

void SpinMargin::observe(HostClock::duration lateness) noexcept {
  const auto us = std::clamp<microseconds::rep>(
      std::chrono::duration_cast<microseconds>(lateness).count(), 0, most.count());
  ++counts_[static_cast<std::size_t>(us)];
  if (++seen_ == ticks_per_second_) adapt();
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

std::string describe_policy(const PaceOptions& options) {
  std::string name(policy_names[static_cast<std::size_t>(options.policy)]);
  if (options.policy == OverrunPolicy::catch_up) name += ":" + std::to_string(options.max_catch_up);
  return name;
}

Result<void> parse_policy(std::string_view text, PaceOptions& options) {
  const Error unknown{Errc::usage, std::string(text) + ": use skip, catch-up:N with N from 1 to " +
                                       std::to_string(max_burst) + ", re-anchor or sample"};
  const std::size_t colon = text.find(':');
  const auto policy = enumerator_named<OverrunPolicy>(policy_names, text.substr(0, colon));
  if (!policy) return unknown;
  if (colon != std::string_view::npos) {
    const auto most = number_in<unsigned>(text.substr(colon + 1));
    if (*policy != OverrunPolicy::catch_up || !most || *most < 1 || *most > max_burst)
      return unknown;
    options.max_catch_up = *most;
  }
  options.policy = *policy;
  return {};
}

Pacer::Pacer(const PaceOptions& options, HostTime start, EventCount* event_count) noexcept
    : options_(options), grid_(start, options.rate_hz), event_count_(event_count) {
  assert(options.policy != OverrunPolicy::sample || event_count != nullptr);
  assert(options.max_catch_up >= 1);
  if (options.spin && options.policy != OverrunPolicy::sample)
    margin_.emplace(grid_.deadline(1) - grid_.deadline(0));
}

Pacer::Due Pacer::wait() noexcept {
  Due due;
  due.number = next_;
  due.missed = std::exchange(missed_, 0);
  if (options_.policy == OverrunPolicy::sample) {
    const HostTime begin = HostClock::now();
    const HostTime end = begin + options_.longest_wait;
    due.scheduled = event_count_->wait(end) ? begin : end;
    due.woke = HostClock::now();
    return due;
  }
  due.scheduled = next_deadline();
  if (margin_) {
    sleep_and_spin(due);
  } else {
    sleep_until(due.scheduled);
    due.woke = HostClock::now();
  }
  return due;
}

void Pacer::sleep_and_spin(Due& due) noexcept {
  const HostTime target = due.scheduled - margin_->get();
  if (HostClock::now() < target) {
    sleep_until(target);
    margin_->observe(HostClock::now() - target);
  }
  const HostTime begin = HostClock::now();
  due.woke = begin;
  for (; due.woke < due.scheduled; due.woke = HostClock::now())
    relax();
  due.spun = due.woke - begin;
}

bool Pacer::end_tick(HostTime now) noexcept {
  ++next_;
  if (options_.policy == OverrunPolicy::sample || now < next_deadline()) return false;
  if (options_.policy == OverrunPolicy::re_anchor) {
    grid_ = TickGrid(now, options_.rate_hz);
    first_of_grid_ = next_;
    return true;
  }
  // first_after counts from the grid's beginning; catching up leaves the newest that have passed.
  const std::uint64_t to_come = first_of_grid_ + grid_.first_after(now);
  const std::uint64_t kept = options_.policy == OverrunPolicy::catch_up ? options_.max_catch_up : 0;
  const std::uint64_t next = to_come - std::min(kept, to_come - next_);
  missed_ = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(next - next_, std::numeric_limits<std::uint32_t>::max()));
  next_ = next;
  return true;
}

} // namespace nendo::flow
