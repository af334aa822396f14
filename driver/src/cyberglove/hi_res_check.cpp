#include "cyberglove/hi_res_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cyberglove/cyberglove_protocol.hpp"

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t frames_a_second = 30;
constexpr std::int64_t seconds_a_day = 86'400;
/// A sub-frame that is seen once may be a wrong digit.
constexpr int times_seen = 2;
/// By which a record may seem to come too early: bytes come in portions.
constexpr auto early_tolerance = 200ms;
/// By which the two clocks may drift apart: a thousandth is more than any quartz.
constexpr int clock_drift_part = 1000;
/// Of three numbers in a row that do not fit, the last one begins a new count.
constexpr std::int64_t max_strays = 3;
constexpr int confusion_by_contradiction = 3;
constexpr int max_confusion = 60;

} // namespace

HiResCheck::HiResCheck(double rate_hz) noexcept
    : sub_frames_(std::llround(rate_hz / third_frame_step_hz)) {}

Verdict HiResCheck::operator()(const Record& record, HostTime arrival) noexcept {
  if (given_up_) return {};
  const Mark mark{record.second, record.frame, record.sub_frame, arrival, {}};
  return known_ ? count(mark) : learn(mark);
}

/// Counts the first records once the numbering is known.
Verdict HiResCheck::learn(const Mark& mark) noexcept {
  first_[static_cast<std::size_t>(learnt_)] = mark;
  ++seen_[mark.sub_frame];
  if (++learnt_ < learning_records) return {};
  known_ = true;
  const auto is_sent = [](int times) { return times >= times_seen; };
  const auto begin = std::find_if(seen_.begin(), seen_.end(), is_sent);
  const auto end = std::find_if(seen_.rbegin(), seen_.rend(), is_sent).base();
  sub_frames_ = std::max({std::int64_t{1}, sub_frames_, std::int64_t{end - begin}});
  std::int64_t common = 0;
  for (std::size_t k = 1; k < first_.size(); ++k)
    common = std::gcd(common, steps(first_[k - 1], first_[k]));
  stride_ = std::max(std::int64_t{1}, common);
  Verdict all;
  for (const Mark& one : first_)
    all.missed += count(one).missed;
  return all;
}

std::int64_t HiResCheck::in_a_second() const noexcept {
  return frames_a_second * sub_frames_;
}

HostClock::duration HiResCheck::time_of(std::int64_t records) const noexcept {
  return from_seconds(static_cast<double>(records) / static_cast<double>(in_a_second()));
}

/// By the clock alone, from 0 up to a day.
std::int64_t HiResCheck::difference(const Mark& from, const Mark& to) const noexcept {
  const auto number = [&](const Mark& mark) {
    return (mark.second * frames_a_second + mark.frame) * sub_frames_ + mark.sub_frame;
  };
  const std::int64_t day = seconds_a_day * in_a_second();
  return ((number(to) - number(from)) % day + day) % day;
}

/// Records from one to the other, 1 if none is between them; 0 if the numbers contradict.
std::int64_t HiResCheck::steps(const Mark& from, const Mark& to) const noexcept {
  const std::int64_t passed = difference(from, to);
  const bool is_early =
      time_of(passed) > to.arrival - from.arrival + from.lateness + early_tolerance;
  if (passed > 0 && !is_early && !seconds_stand_) return passed / stride_;
  return steps_by_arrival(from, to, passed);
}

/// The same where only the clock's frames within a second are right.
std::int64_t HiResCheck::steps_by_arrival(const Mark& from, const Mark& to,
                                          std::int64_t difference) const noexcept {
  const auto second = static_cast<double>(in_a_second());
  const double expected = to_seconds(to.arrival - from.arrival) * second;
  const auto part = static_cast<double>(difference % in_a_second());
  const double passed = part + second * std::max(0.0, std::round((expected - part) / second));
  if (std::abs(passed - expected) > second / 4) return 0;
  return static_cast<std::int64_t>(passed) / stride_;
}

Verdict HiResCheck::count(Mark mark) noexcept {
  if (!last_) {
    last_ = mark;
    return {};
  }
  std::int64_t taken = steps(*last_, mark);
  if (taken == 0 && before_ && strays_ == 0) { // was it the last one's number that was wrong?
    const std::int64_t since_before = steps(*before_, mark);
    if (since_before > 1) {
      taken = since_before;
      gap_ = 0;
      last_ = before_;
      strays_ = strays_before_ + 1;
    }
  }
  if (taken == 0) return contradict(mark);
  accept(mark, taken);
  const std::int64_t gap = std::max(std::int64_t{0}, taken - 1 - strays_);
  before_ = std::exchange(last_, mark);
  strays_before_ = std::exchange(strays_, 0);
  return {true, static_cast<std::uint64_t>(std::exchange(gap_, gap))};
}

void HiResCheck::accept(Mark& mark, std::int64_t taken) noexcept {
  doubt_ = std::max(0, doubt_ - 1);
  const bool by_clock = difference(*last_, mark) / stride_ == taken;
  if (by_clock && mark.second != last_->second) seconds_stand_ = false;
  if (!by_clock) seconds_stand_ = true;
  const auto waited = mark.arrival - last_->arrival;
  mark.lateness =
      std::max(HostClock::duration{0},
               last_->lateness + waited - time_of(taken * stride_) - waited / clock_drift_part);
}

Verdict HiResCheck::contradict(const Mark& mark) noexcept {
  doubt_ += confusion_by_contradiction;
  given_up_ = doubt_ >= max_confusion;
  if (++strays_ < max_strays) return {};
  const auto missed = static_cast<std::uint64_t>(std::exchange(gap_, 0));
  before_.reset();
  strays_ = strays_before_ = 0;
  last_ = mark;
  return {true, missed};
}

} // namespace nendo::driver::cyberglove
