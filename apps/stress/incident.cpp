#include "stress/incident.hpp"

#include <algorithm>
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

} // namespace nendo::stress
