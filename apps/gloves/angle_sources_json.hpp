#pragma once
// Tells as JSON which joints a glove measures, for `nendo info` and for the first line of each
// glove in a stream.

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include <nendo/driver/sample.hpp>

namespace nendo::gloves {

/// Returns an object with the name of each angle's hand::AngleSource: "measured", the rule that
/// estimates it, or "zero".
nlohmann::ordered_json angle_sources_json(SensorMask sensors);

/// Distinguishes the first sample of each glove from the others, by its hand and sensors.
class GloveChanges {
public:
  bool is_first(Side side, SensorMask sensors) noexcept {
    const bool first = !sensors_ || side != side_ || sensors != *sensors_;
    side_ = side;
    sensors_ = sensors;
    return first;
  }

private:
  Side side_ = Side::right;
  std::optional<SensorMask> sensors_; ///< nullopt: no sample came yet
};

} // namespace nendo::gloves
