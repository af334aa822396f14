#include "stress/incident.hpp"

#include <algorithm>
#include <charconv>
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

} // namespace nendo::stress
