#include "session/range_report.hpp"

#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

namespace nendo::session {
namespace {

template <class Visit>
void for_each(const hand::SensorRanges& ranges, SensorMask sensors, Visit&& visit) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (sensors.has(static_cast<Sensor>(slot)))
      visit(std::string(sensor_names[slot]), ranges[slot]);
}

} // namespace

nlohmann::ordered_json ranges_json(const hand::SensorRanges& ranges, SensorMask sensors) {
  nlohmann::ordered_json by_sensor = nlohmann::ordered_json::object();
  for_each(ranges, sensors, [&](const std::string& name, const hand::SensorRange& range) {
    by_sensor[name] = {{"low_counts", range.low_counts},
                       {"high_counts", range.high_counts},
                       {"turns", range.turns}};
  });
  return by_sensor;
}

void print_ranges(const hand::SensorRanges& ranges, SensorMask sensors) {
  std::printf("  %-14s ranges learned, in counts, from so many turns of the joint:\n", "");
  for_each(ranges, sensors, [](const std::string& name, const hand::SensorRange& range) {
    std::printf("  %-14s %-22s %5.0f to %5.0f  %s\n", "", name.c_str(), range.low_counts,
                range.high_counts,
                range.turns > 0 ? std::to_string(range.turns).c_str() : "none: the default's");
  });
}

} // namespace nendo::session
