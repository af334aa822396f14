#include <nendo/flow/pacer.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <limits>
#include <utility>

#include <nendo/base/relax.hpp>

namespace nendo::flow {
namespace {

constexpr std::array<std::string_view, 4> policy_names{"skip", "catch-up", "re-anchor", "sample"};
constexpr unsigned max_burst = 1000;

} // namespace

std::string describe_policy(const PaceOptions& options) {
  std::string name(policy_names[static_cast<std::size_t>(options.policy)]);
  if (options.policy == OverrunPolicy::catch_up) name += ":" + std::to_string(options.max_catch_up);
  return name;
}

Result<void> parse_policy(std::string_view text, PaceOptions& options) {
  const Error unknown{Errc::usage, std::string(text) + ": use skip, catch-up:N with N from 1 to " +
                                       std::to_string(max_burst) + ", re-anchor or sample"};
  const std::size_t colon = text.find(':');
  const auto name = std::find(policy_names.begin(), policy_names.end(), text.substr(0, colon));
  if (name == policy_names.end()) return unknown;
  const auto policy = static_cast<OverrunPolicy>(name - policy_names.begin());
  if (colon != std::string_view::npos) {
    const std::string_view digits = text.substr(colon + 1);
    unsigned most = 0;
    const char* const end = digits.data() + digits.size();
    const auto [stopped, error] = std::from_chars(digits.data(), end, most);
    if (policy != OverrunPolicy::catch_up || error != std::errc{} || stopped != end || most < 1 ||
        most > max_burst)
      return unknown;
    options.max_catch_up = most;
  }
  options.policy = policy;
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
