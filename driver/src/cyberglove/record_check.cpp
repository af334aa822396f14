#include "cyberglove/record_check.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace nendo::driver::cyberglove {
namespace {

/// Each of the two gaps of a new clock may err by two sixteenths, as those of the known one.
constexpr std::uint32_t equal_part = 4;
/// Two records that are sampled late cannot be closer.
constexpr std::uint32_t min_late_part = 16;
/// Longer jumps are believed only when later records bear them out: a stamp with a wrong upper bit
/// looks the same.
constexpr std::uint32_t max_periods = 16;
/// A longer one is a new clock. The reader starts a silent stream again long before.
constexpr std::uint32_t seconds_60 = 60 * 115'200;
/// No glove is used with fewer records than one in four minutes; leaves room for 16 periods.
constexpr std::uint32_t longest_period = std::uint32_t{1} << 25U;

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

} // namespace

RecordCheck::RecordCheck(std::uint64_t period_ticks) noexcept
    : period_(period_ticks <= longest_period ? static_cast<std::uint32_t>(period_ticks) : 0),
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
  const bool advances = step.gap != 0 && step.gap <= longest_gap();
  suspects_ = {before.count > 0 && advances ? 2 : 1, record.ticks, record.sampled_too_fast, step};
  if (before.count < agreeing_records - 1 || !advances) return 0;
  const std::uint32_t longer = std::max(before.step.gap, step.gap);
  const bool equal = distance(before.step.gap, step.gap) <= longer / (steady_ ? equal_part : 2);
  // The same number of records lost twice is less likely than another period.
  const bool same_period = keeps_period(before.step) && keeps_period(step) &&
                           !(equal && whole_periods(step.gap, period_) > 1);
  if (same_period) return period_;
  return equal ? std::min(step.gap, longest_period) : 0;
}

/// Three records agree with each other: their clock and their period hold from now on.
Verdict RecordCheck::begin_again(Record& record, std::uint32_t agreed) noexcept {
  const std::uint32_t gap = record.ticks - last_ticks_;
  const bool late = last_late_ || record.sampled_too_fast;
  if (trusted_ && agreed == period_ && gap <= longest_gap() &&
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
  if (period_ == 0) return step.gap <= longest_gap() ? 1 : 0;
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
  const bool tells = steady_ && trusted_ && !step.was_late && !step.is_late && step.gap != 0 &&
                     step.gap <= max_periods * period_;
  if (!tells) return;
  jitter_.learn(step.gap, period_);
  if (jitter_.hides(period_)) steady_ = false;
}

/// Learns from an accepted step. Returns the records that were missed.
std::uint64_t RecordCheck::follow(const Step& step, std::uint32_t count) noexcept {
  late_pace_ = step.was_late && step.is_late ? std::min(step.gap / count, longest_period) : 0;
  if (steady_) return count - 1;
  if (gap_count_ < gaps_.size()) return learn(step.gap);
  // A mean over about eight records, in which no single one weighs much.
  const auto pace = std::int64_t{step.gap / count};
  period_ = std::min(static_cast<std::uint32_t>(period_ + (pace - std::int64_t{period_}) / 8),
                     longest_period);
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
  period_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(total / count, longest_period));
  const std::uint64_t missed = count - gaps.size();
  const std::uint64_t counted = learnt_missed_;
  learnt_missed_ = std::max(missed, counted);
  return learnt_missed_ - counted;
}

std::uint32_t RecordCheck::longest_gap() const noexcept {
  return std::max(seconds_60, max_periods * period_);
}

} // namespace nendo::driver::cyberglove
