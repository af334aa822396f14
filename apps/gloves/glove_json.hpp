#pragma once
// Gloves and their samples as JSON, for `nendo info`, `nendo monitor` and the summaries.

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include <nendo/driver/glove.hpp>
#include <nendo/driver/record_counts.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/sculpting/find_wearer.hpp>

namespace nendo::gloves {

/// Returns an object with the name of each angle's hand::AngleSource: "measured", the rule that
/// estimates it, or "zero". Some of the sensors may be left out.
nlohmann::ordered_json angle_sources_json(SensorMask sensors, SensorMask left_out = {});

nlohmann::ordered_json sensors_json(SensorMask sensors);

/// Returns "on", "off", or null if the glove does not report the switch.
nlohmann::ordered_json switch_json(WristSwitch position);

/// Returns an object with the keys source, model, hand, sensors, angles (angle_sources_json()),
/// rate_hz, counts (most, whole_range), abilities and facts.
nlohmann::ordered_json glove_json(const driver::GloveInfo& info);

/// Returns an object with OpenXR's names of joints in OpenXR's order, each with position_m [x, y,
/// z] and orientation_xyzw, a unit quaternion whose w is not negative.
nlohmann::ordered_json joints_json(const hand::HandPose& pose);

/// Adds the counts to an object, under the names of driver::by_name().
void add_counts(nlohmann::ordered_json& object, const driver::RecordCounts& counts);

/// Distinguishes the first sample of each glove from the others, by its hand and sensors, and by
/// those that are left out of it.
class GloveChanges {
public:
  bool is_first(Side side, SensorMask sensors, SensorMask left_out = {}) noexcept {
    const bool first = !sensors_ || side != side_ || sensors != *sensors_ || left_out != left_out_;
    side_ = side;
    sensors_ = sensors;
    left_out_ = left_out;
    return first;
  }

private:
  Side side_ = Side::right;
  std::optional<SensorMask> sensors_; ///< nullopt: no sample came yet
  SensorMask left_out_;
};

/// Returns one object without a line end. Its keys are time_s and measured_s (host clock; of a
/// replayed sample those with which it was recorded, and replayed_s is the moment of replay),
/// sequence, hand, switch ("on", "off", or null if the glove does not report it), raw (counts by
/// sensor), device_time_s if the glove has a clock, and angle_rad (by sensor) unless `calibration`
/// is null. It contains only sensors that the sample has, and only angles that the calibration
/// knows. With `with_sources`, unless `calibration` is null, there is also the key angles, with
/// what angle_sources_json() returns, and calibration, with what calibration_json() returns, unless
/// `found` is null. If some sensors are `left_out`, the key left_out has their names, and angle_rad
/// has estimates for them.
std::string sample_json(const GloveSample& sample, const hand::Calibration* calibration,
                        bool with_sources = false,
                        const sculpting::FoundCalibration* found = nullptr,
                        SensorMask left_out = {});

/// Returns an object with the keys kind ("average", "stored", "recorded", "learned"), user and path
/// (null if there is none): whose hand the angles are.
nlohmann::ordered_json calibration_json(const sculpting::FoundCalibration& found);

} // namespace nendo::gloves
