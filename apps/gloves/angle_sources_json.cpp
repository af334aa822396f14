#include "gloves/angle_sources_json.hpp"

#include <string>

#include <nlohmann/json.hpp>

#include <nendo/hand/angle_sources.hpp>

namespace nendo::gloves {

nlohmann::ordered_json angle_sources_json(SensorMask sensors) {
  const hand::AngleSources sources = hand::angle_sources(sensors);
  nlohmann::ordered_json by_angle = nlohmann::ordered_json::object();
  for (std::size_t n = 0; n < hand::angle_count; ++n)
    by_angle[std::string(hand::angle_names[n])] = name_of(sources[n]);
  return by_angle;
}

} // namespace nendo::gloves
