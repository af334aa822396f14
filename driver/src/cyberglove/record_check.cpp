#include "cyberglove/record_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "cyberglove/cyberglove_protocol.hpp"

namespace nendo::driver::cyberglove {
namespace {

using namespace std::chrono_literals;

/// Returns `gap` in periods, rounded, at least 1. It has 64 bits, as both may be large.
std::uint32_t whole_periods(std::uint64_t gap, std::uint64_t period) noexcept {
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, (gap + period / 2) / period));
}

// StampJitter.

/// Stamp and period come from one clock, so that a stamp errs only by delays of the firmware:
/// interrupts, and the conversion of a few channels. No source gives their length. A sixteenth of a
/// period (0.6 ms at 100 Hz) is always allowed. Between two stamps that is an eighth, into which a
/// wrong stamp falls by chance in one of four cases.
constexpr std::uint32_t min_part = 8;
/// Where records were lost, a device that is known to be punctual is allowed less: a wrong bit that
/// fits makes the stamp some periods longer there, and all of them would be counted as missed.
constexpr std::uint32_t min_part_after_loss = 16;
/// Until the mean is known, a quarter of a period is allowed.
constexpr std::uint32_t unknown_part = 4;
/// A device whose stamps wander more is allowed five times its mean deviation: if stamps err evenly
/// to both sides, the largest one is three times the mean.
constexpr std::uint32_t times_mean = 5;
/// Number of deviations in the mean. A single wrong stamp in it widens nothing.
constexpr std::uint32_t mean_steps = 16;
/// No single deviation counts for more, so that stamps are only taken to wander if more than half
/// of them do.
constexpr std::uint32_t max_counted_part = 4;
/// Beyond three eighths late and early look the same. A mean of an eighth is a period that is
/// not kept closely.
constexpr std::uint32_t max_eighths = 3;
constexpr std::uint32_t hidden_part = 8;
constexpr std::uint32_t fraction = 256; ///< deviations are summed in this fraction of a tick

/// The difference between the gap and a whole number of periods.
std::uint32_t deviation(std::uint32_t gap, std::uint32_t period) noexcept {
  const std::uint32_t whole = whole_periods(gap, period) * period;
  return gap > whole ? gap - whole : whole - gap;
}

// RecordCheck.

/// Each of the two gaps of a new clock may err by two sixteenths, as those of the known one.
constexpr std::uint32_t equal_part = 4;
/// Two records that are sampled late cannot be closer.
constexpr std::uint32_t min_late_part = 16;
/// Longer jumps are believed only when later records bear them out: a stamp with a wrong upper bit
/// looks the same.
constexpr std::uint32_t max_periods = 16;
/// A longer one is a new clock. The reader starts a silent stream again long before.
constexpr std::uint32_t seconds_60 = 60 * 115'200;
/// No glove is used with fewer records than one in four minutes; 16 periods fit into 32 bits.
constexpr std::uint32_t max_period_ticks = std::uint32_t{1} << 25U;

constexpr int agreeing_records = 3;
constexpr int doubt_by_refusal =
    4;                        ///< an acceptance takes 1 back: more than one in five are refused
constexpr int max_doubt = 32; ///< eight refusals in a row

std::uint32_t distance(std::uint32_t a, std::uint32_t b) noexcept {
  return a > b ? a - b : b - a;
}

/// `gap` in periods where these vary: a record is rather late than early, so one and three quarters
/// of a period still hide no other record.
std::uint32_t loosely_rounded(std::uint32_t gap, std::uint32_t period) noexcept {
  return std::uint64_t{4} * gap < std::uint64_t{7} * period ? 1 : whole_periods(gap, period);
}

// HiResCheck.

constexpr std::int64_t frames_in_second = 30;
constexpr std::int64_t seconds_per_day = 86'400;
/// A sub-frame that is seen once may be a wrong digit.
constexpr int times_seen = 2;
/// The time by which a record may seem to come too early: bytes come in portions.
constexpr auto early_tolerance = 200ms;
/// Max relative drift of the two clocks: a thousandth is more than any quartz.
constexpr int clock_drift_part = 1000;
/// Of three numbers in a row that do not fit, the last one begins a new count.
constexpr std::int64_t max_strays = 3;
constexpr int confusion_by_contradiction = 3;
constexpr int max_confusion = 60;

} // namespace

std::uint64_t StampJitter::mean() const noexcept {
  return sum_ / (std::uint64_t{mean_steps} * fraction);
}

void StampJitter::learn(std::uint32_t gap, std::uint32_t period) noexcept {
  const std::uint64_t now =
      std::uint64_t{fraction} * std::min(deviation(gap, period), period / max_counted_part);
  if (known_ == mean_steps) {
    sum_ = sum_ - sum_ / mean_steps + now;
    return;
  }
  // The mean of the known deviations, as if there were mean_steps of them.
  const std::uint64_t sum = sum_ * known_ / mean_steps + now;
  sum_ = sum * mean_steps / ++known_;
}

bool StampJitter::allows(std::uint32_t gap, std::uint32_t period) const noexcept {
  const std::uint32_t part = whole_periods(gap, period) != 1 ? min_part_after_loss
                             : known_ < mean_steps           ? unknown_part
                                                             : min_part;
  const std::uint64_t max_allowed = std::uint64_t{period} * max_eighths / 8;
  const std::uint64_t allowed =
      std::max<std::uint64_t>(period / part, std::min(max_allowed, times_mean * mean()));
  return deviation(gap, period) <= allowed;
}

bool StampJitter::hides(std::uint32_t period) const noexcept {
  return known_ == mean_steps && mean() > period / hidden_part;
}

RecordCheck::RecordCheck(std::uint64_t period_ticks) noexcept
    : period_(period_ticks <= max_period_ticks ? static_cast<std::uint32_t>(period_ticks) : 0),
      steady_(period_ != 0) {
  if (steady_) gap_count_ = gaps_.size(); // nothing to learn
}

Verdict RecordCheck::operator()(Record& record) noexcept {
  if (record.status != 0 && !status_agrees(record.status)) return refuse();
  return record.stamp == Stamp::none ? Verdict{} : check_stamp(record);
}

/// Switch and light change; the reserved bits do not, and without a glove there is no record.
bool RecordCheck::status_agrees(std::uint8_t status) noexcept {
  if ((status & status_always) == 0 || (status & status_plugged_in) == 0) return false;
  const std::uint8_t constant = status & status_reserved;
  if (!std::exchange(status_known_, true)) status_constant_ = constant;
  if (constant != status_constant_) {
    status_suspects_ = constant == status_suspect_ ? status_suspects_ + 1 : 1;
    status_suspect_ = constant;
    if (status_suspects_ < agreeing_records) return false;
    status_constant_ = constant;
  }
  status_suspects_ = 0;
  return true;
}

Verdict RecordCheck::check_stamp(Record& record) noexcept {
  if (!begun_) {
    begun_ = true;
    record.stamp = Stamp::begins;
    return accept(record, 0);
  }
  const Step step{record.ticks - last_ticks_, last_late_, record.sampled_too_fast};
  learn_jitter(step);
  if (const std::uint32_t count = trusted_ ? periods(step) : 0; count != 0) {
    doubt_ = std::max(0, doubt_ - 1);
    return accept(record, follow(step, count));
  }
  if (const std::uint32_t agreed = agreed_period(record); agreed != 0) {
    return begin_again(record, agreed);
  }
  if (!trusted_) {
    record.stamp = Stamp::none;
    return {true, std::exchange(refused_, 0)};
  }
  doubt_ += doubt_by_refusal;
  return doubt_ < max_doubt ? refuse() : lose_trust(record);
}

Verdict RecordCheck::refuse() noexcept {
  ++refused_;
  return {false, 0};
}

Verdict RecordCheck::accept(const Record& record, std::uint64_t missed) noexcept {
  last_ticks_ = record.ticks;
  last_late_ = record.sampled_too_fast;
  suspects_ = {};
  refused_ = 0;
  return {true, missed};
}

/// Takes the record among the suspects. If it is the third that makes sense with the two before,
/// their period, else 0.
std::uint32_t RecordCheck::agreed_period(const Record& record) noexcept {
  const Suspects before = suspects_;
  const Step step{record.ticks - before.ticks, before.late, record.sampled_too_fast};
  const bool advances = step.gap != 0 && step.gap <= max_gap();
  suspects_ = {before.count > 0 && advances ? 2 : 1, record.ticks, record.sampled_too_fast, step};
  if (before.count < agreeing_records - 1 || !advances) return 0;
  const std::uint32_t longer = std::max(before.step.gap, step.gap);
  const bool equal = distance(before.step.gap, step.gap) <= longer / (steady_ ? equal_part : 2);
  // The same number of records lost twice is less likely than another period.
  const bool same_period = keeps_period(before.step) && keeps_period(step) &&
                           !(equal && whole_periods(step.gap, period_) > 1);
  if (same_period) return period_;
  return equal ? std::min(step.gap, max_period_ticks) : 0;
}

/// Three records agree with each other: their clock and their period hold from now on.
Verdict RecordCheck::begin_again(Record& record, std::uint32_t agreed) noexcept {
  const std::uint32_t gap = record.ticks - last_ticks_;
  const bool late = last_late_ || record.sampled_too_fast;
  if (trusted_ && agreed == period_ && gap <= max_gap() &&
      (!steady_ || late || jitter_.allows(gap, period_))) {
    doubt_ = std::max(0, doubt_ - doubt_by_refusal * (agreeing_records - 1));
    return accept(record, whole_periods(gap, period_) - 1);
  }
  if (agreed != period_ && !steady_) {
    gaps_[0] = agreed;
    gap_count_ = 1;
    learnt_missed_ = 0;
  }
  if (agreed != period_) jitter_.forget();
  period_ = agreed;
  late_pace_ = 0;
  doubt_ = 0;
  trusted_ = true;
  record.stamp = Stamp::begins;
  return accept(record, refused_);
}

/// The stamps contradict each other again and again. Perhaps they only do not keep the period.
Verdict RecordCheck::lose_trust(Record& record) noexcept {
  doubt_ = 0;
  const std::uint64_t missed = refused_;
  if (!std::exchange(steady_, false)) {
    trusted_ = false;
    record.stamp = Stamp::none;
    refused_ = 0;
    return {true, missed};
  }
  const Step step{record.ticks - last_ticks_, last_late_, record.sampled_too_fast};
  if (keeps_period(step)) return accept(record, follow(step, periods(step)));
  record.stamp = Stamp::begins;
  return accept(record, missed);
}

/// How many periods the step takes; 0 if it contradicts.
std::uint32_t RecordCheck::periods(const Step& step) const noexcept {
  if (step.gap == 0) return 0;
  if (period_ == 0) return step.gap <= max_gap() ? 1 : 0;
  if (step.gap > max_periods * std::max(period_, late_pace_)) return 0;
  if (steady_) return steady_periods(step);
  if (step.gap >= period_ / 2) return loosely_rounded(step.gap, period_);
  // Records may have been lost in what seemed to be a period so far.
  return gap_count_ < gaps_.size() ? 1 : 0;
}

/// Without making the period shorter.
bool RecordCheck::keeps_period(const Step& step) const noexcept {
  return period_ != 0 && periods(step) != 0 && (steady_ || step.gap >= period_ / 2);
}

/// A record that is sampled late is so by less than three quarters of a period, or one was left
/// out.
std::uint32_t RecordCheck::steady_periods(const Step& step) const noexcept {
  if (!step.was_late && !step.is_late) {
    return jitter_.allows(step.gap, period_) ? whole_periods(step.gap, period_) : 0;
  }
  if (step.gap < period_ / min_late_part) return 0;
  if (step.was_late && step.is_late) {
    // The glove's own pace, which is the slower one if it cannot keep its period at all.
    return late_pace_ == 0 ? 1 : loosely_rounded(step.gap, std::max(period_, late_pace_));
  }
  const std::uint32_t slack = period_ / 4;
  const std::uint32_t count =
      step.is_late ? (step.gap + slack) / period_ : (step.gap + period_ - 1 - slack) / period_;
  return std::max(1U, count);
}

/// Before the record is judged. Wrong stamps count as well.
void RecordCheck::learn_jitter(const Step& step) noexcept {
  const bool usable = steady_ && trusted_ && !step.was_late && !step.is_late && step.gap != 0 &&
                      step.gap <= max_periods * period_;
  if (!usable) return;
  jitter_.learn(step.gap, period_);
  if (jitter_.hides(period_)) steady_ = false;
}

/// Learns from an accepted step. Returns the records that were missed.
std::uint64_t RecordCheck::follow(const Step& step, std::uint32_t count) noexcept {
  late_pace_ = step.was_late && step.is_late ? std::min(step.gap / count, max_period_ticks) : 0;
  if (steady_) return count - 1;
  if (gap_count_ < gaps_.size()) return learn(step.gap);
  // A mean over about eight records, in which no single one weighs much.
  const auto pace = std::int64_t{step.gap / count};
  period_ = std::min(static_cast<std::uint32_t>(period_ + (pace - std::int64_t{period_}) / 8),
                     max_period_ticks);
  return count - 1;
}

/// The shortest of the first gaps is one period, the others are as many as they hold of it. Returns
/// what was missed in all of them and not yet counted.
std::uint64_t RecordCheck::learn(std::uint32_t gap) noexcept {
  gaps_[gap_count_++] = gap;
  const auto gaps = std::span(gaps_).first(gap_count_);
  const std::uint32_t shortest = *std::min_element(gaps.begin(), gaps.end());
  std::uint64_t total = 0;
  std::uint64_t count = 0;
  for (const std::uint32_t one : gaps) {
    total += one;
    count += loosely_rounded(one, shortest);
  }
  period_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(total / count, max_period_ticks));
  const std::uint64_t missed = count - gaps.size();
  const std::uint64_t counted = learnt_missed_;
  learnt_missed_ = std::max(missed, counted);
  return learnt_missed_ - counted;
}

std::uint32_t RecordCheck::max_gap() const noexcept {
  return std::max(seconds_60, max_periods * period_);
}

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

std::int64_t HiResCheck::per_second() const noexcept {
  return frames_in_second * sub_frames_;
}

HostClock::duration HiResCheck::time_of(std::int64_t records) const noexcept {
  return from_seconds(static_cast<double>(records) / static_cast<double>(per_second()));
}

/// By the clock alone, from 0 up to a day.
std::int64_t HiResCheck::difference(const Mark& from, const Mark& to) const noexcept {
  const auto number = [&](const Mark& mark) {
    return (mark.second * frames_in_second + mark.frame) * sub_frames_ + mark.sub_frame;
  };
  const std::int64_t day = seconds_per_day * per_second();
  return ((number(to) - number(from)) % day + day) % day;
}

/// Records from one to the other, 1 if none is between them; 0 if the numbers contradict.
std::int64_t HiResCheck::steps(const Mark& from, const Mark& to) const noexcept {
  const std::int64_t passed = difference(from, to);
  const bool is_early =
      time_of(passed) > to.arrival - from.arrival + from.lateness + early_tolerance;
  if (passed > 0 && !is_early && !seconds_stopped_) return passed / stride_;
  return steps_by_arrival(from, to, passed);
}

/// The same where only the clock's frames within a second are right.
std::int64_t HiResCheck::steps_by_arrival(const Mark& from, const Mark& to,
                                          std::int64_t difference) const noexcept {
  const auto second = static_cast<double>(per_second());
  const double expected = to_seconds(to.arrival - from.arrival) * second;
  const auto part = static_cast<double>(difference % per_second());
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
  if (by_clock && mark.second != last_->second) seconds_stopped_ = false;
  if (!by_clock) seconds_stopped_ = true;
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
