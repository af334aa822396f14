#include "stress/tick_tally.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <utility>

namespace nendo::stress {

using std::chrono::nanoseconds;

Incident incident_of(const flow::TickRecord& before, const flow::TickRecord& now,
                     nanoseconds period) noexcept {
  Incident incident;
  incident.tick = now.tick;
  incident.missed = now.missed;
  incident.due = now.scheduled - now.missed * period;
  incident.lateness = now.woke - incident.due;
  const HostTime free = std::max(before.published(), incident.due);
  incident.phase_time = now.woke - free;
  std::uint32_t begin_ns = 0;
  const std::array stages{before.drained_ns, before.posed_ns, before.solved_ns,
                          before.published_ns};
  for (std::size_t k = 0; k < stages.size(); ++k) {
    const HostTime begin = before.woke + nanoseconds(std::exchange(begin_ns, stages[k]));
    const HostTime end = before.woke + nanoseconds(stages[k]);
    const nanoseconds beyond = end - std::max(begin, incident.due);
    if (beyond <= incident.phase_time) continue;
    incident.phase_time = beyond;
    incident.phase = static_cast<Phase>(k + 1);
  }
  return incident;
}

Cause cause_of(const Incident& incident, const UsualTimes& usual,
               std::optional<nanoseconds> waited) noexcept {
  if (waited && *waited >= incident.phase_time / 2) return Cause::preemption;
  if (incident.phase != Phase::wake &&
      incident.phase_time <= 2 * usual[static_cast<std::size_t>(incident.phase)])
    return incident.phase == Phase::input ? Cause::input : Cause::own_work;
  return waited ? Cause::host_gap : Cause::unexplained;
}

std::optional<nanoseconds> parse_run_delay(const std::string& schedstat) {
  const std::size_t space = schedstat.find(' ');
  if (space == std::string::npos) return std::nullopt;
  std::int64_t waited_ns = 0;
  const char* const begin = schedstat.data() + space + 1;
  const char* const end = schedstat.data() + schedstat.size();
  const auto [stopped, error] = std::from_chars(begin, end, waited_ns);
  if (error != std::errc{} || stopped == end || *stopped != ' ' || waited_ns < 0)
    return std::nullopt;
  return nanoseconds(waited_ns);
}

RunDelay::RunDelay(pid_t thread)
    : path_("/proc/self/task/" + std::to_string(thread) + "/schedstat") {}

void RunDelay::sample() {
  std::ifstream file(path_);
  std::string line;
  if (!std::getline(file, line)) return;
  const auto waited = parse_run_delay(line);
  if (!waited) return;
  samples_[count_ % kept] = {HostClock::now(), *waited};
  ++count_;
}

std::optional<nanoseconds> RunDelay::since(HostTime from) const noexcept {
  if (count_ == 0) return std::nullopt;
  const Sample& newest = samples_[(count_ - 1) % kept];
  const std::uint64_t held = std::min<std::uint64_t>(count_, kept);
  for (std::uint64_t back = 1; back <= held; ++back) {
    const Sample& sample = samples_[(count_ - back) % kept];
    if (sample.time <= from) return newest.waited - sample.waited;
  }
  if (held == count_) return newest.waited;
  return std::nullopt;
}

void LatenessTrace::add(HostTime time, nanoseconds lateness) {
  if (slices_.empty()) start_ = time;
  auto at =
      static_cast<std::size_t>(std::max(time - start_, HostClock::duration::zero()) / length_);
  while (at >= max_slices) {
    for (std::size_t k = 0; k < slices_.size(); k += 2) {
      Slice both = slices_[k];
      if (k + 1 < slices_.size()) {
        both.count += slices_[k + 1].count;
        both.sum += slices_[k + 1].sum;
        both.max = std::max(both.max, slices_[k + 1].max);
      }
      slices_[k / 2] = both;
    }
    slices_.resize((slices_.size() + 1) / 2);
    length_ *= 2;
    at /= 2;
  }
  if (at >= slices_.size()) slices_.resize(at + 1);
  Slice& slice = slices_[at];
  ++slice.count;
  slice.sum += lateness;
  slice.max = std::max(slice.max, lateness);
}

TickTally::TickTally(const flow::PaceOptions& pace)
    : period_(std::llround(1e9 / pace.rate_hz)),
      on_grid_(pace.policy != flow::OverrunPolicy::sample) {
  worst_.reserve(max_worst + 1);
}

void TickTally::record(Measure measure, HostClock::duration value) noexcept {
  Distribution& of = distributions_[static_cast<std::size_t>(measure)];
  of.raw.record(value);
  of.corrected.record(value);
  if (!on_grid_ || measure == Measure::lateness) return;
  for (value -= period_; value > HostClock::duration::zero(); value -= period_)
    of.corrected.record(value);
}

void TickTally::add_stages(const flow::TickRecord& record) noexcept {
  stages_[0].record(nanoseconds(record.spun_ns));
  std::uint32_t begin_ns = 0;
  const std::array ends{record.drained_ns, record.posed_ns, record.solved_ns, record.published_ns};
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const nanoseconds took(ends[k] - std::exchange(begin_ns, ends[k]));
    stages_[k + 1].record(took);
    if (record.samples > 0) busy_stages_[k + 1].record(took);
  }
}

UsualTimes TickTally::usual_times() const noexcept {
  UsualTimes usual{};
  for (std::size_t k = 1; k < usual.size(); ++k)
    usual[k] = (busy_stages_[k].count() > 0 ? busy_stages_[k] : stages_[k]).percentile(0.99);
  return usual;
}

void TickTally::add(const flow::TickRecord& record_now, const RunDelay* delay) {
  ++ticks_;
  samples_ += record_now.samples;
  add_stages(record_now);
  record(Measure::work, nanoseconds(record_now.published_ns));
  if (record_now.samples > 0) {
    const HostTime drained = record_now.woke + nanoseconds(record_now.drained_ns);
    record(Measure::input_age, drained - record_now.input);
    record(Measure::end_to_end, record_now.published() - record_now.input);
  }
  // Paced by samples, a tick without any has nothing that it could be late for.
  if (on_grid_ || record_now.samples > 0) add_step(before_.value_or(record_now), record_now, delay);
  before_ = record_now;
}

void TickTally::add_step(const flow::TickRecord& before, const flow::TickRecord& now,
                         const RunDelay* delay) {
  record(Measure::lateness, now.woke - now.scheduled);
  auto& lateness = distributions_[static_cast<std::size_t>(Measure::lateness)].corrected;
  for (std::uint32_t k = 1; k <= now.missed; ++k)
    lateness.record(now.woke - now.scheduled + k * period_);
  if (before_) {
    const nanoseconds step = now.woke - before.woke;
    longest_outage_ = std::max(longest_outage_, step);
    if (on_grid_) record(Measure::period_error, std::chrono::abs(step - period_));
  }
  trace_.add(now.woke, now.woke - now.scheduled);

  Incident incident = incident_of(before, now, period_);
  const bool among_worst = worst_.size() < max_worst || incident.lateness > worst_.back().lateness;
  if (incident.lateness <= incident_threshold && !among_worst) return;
  incident.cause = cause_of(incident, usual_times(),
                            delay == nullptr ? std::nullopt : delay->since(incident.due));
  if (incident.lateness > incident_threshold) {
    Share& share = causes_[static_cast<std::size_t>(incident.cause)];
    ++share.incidents;
    share.lateness += incident.lateness;
  }
  if (!among_worst) return;
  const auto at = std::upper_bound(
      worst_.begin(), worst_.end(), incident,
      [](const Incident& a, const Incident& b) { return a.lateness > b.lateness; });
  worst_.insert(at, incident);
  if (worst_.size() > max_worst) worst_.pop_back();
}

double TickTally::explained() const noexcept {
  nanoseconds all{};
  for (const Share& share : causes_)
    all += share.lateness;
  const auto unknown = causes_[static_cast<std::size_t>(Cause::unexplained)].lateness;
  return all.count() == 0
             ? 1.0
             : 1.0 - static_cast<double>(unknown.count()) / static_cast<double>(all.count());
}

} // namespace nendo::stress
