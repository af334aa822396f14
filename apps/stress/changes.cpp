#include "stress/changes.hpp"

namespace nendo::stress {

bool changes_at(HostTime start, HostTime time) noexcept {
  return static_cast<std::int64_t>(to_seconds(time - start)) % 2 != 0;
}

void count(const flow::TickRecord& record, HostTime start, ChangeTallies& tallies) noexcept {
  ChangeTally& tally = tallies[changes_at(start, record.scheduled) ? 1 : 0];
  ++tally.ticks;
  tally.missed += record.missed;
  tally.lateness.record(record.woke - record.scheduled);
  tally.work.record(record.published() - record.woke);
}

void SettingsChanger::update(flow::DeformLoop& loop, HostTime start) {
  const HostTime now = HostClock::now();
  if (per_minute_ <= 0.0 || now < next_ || !changes_at(start, now)) return;
  constexpr double seconds_a_minute = 60.0;
  next_ = std::max(next_, now - std::chrono::milliseconds(100)) +
          from_seconds(seconds_a_minute / per_minute_);
  // There and back, so that the hands shape the same all the time.
  constexpr double larger = 1.25;
  flow::LoopSettings settings = loop.changes().settings();
  for (double& radius_m : settings.radius_m)
    radius_m *= asked_ % 2 == 0 ? larger : 1.0 / larger;
  if (loop.changes().change_settings(settings)) ++asked_;
}

} // namespace nendo::stress
