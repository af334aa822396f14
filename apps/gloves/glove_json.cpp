#include "gloves/glove_json.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/joint_angles.hpp>

#include "cli/cli.hpp"

namespace nendo::gloves {
namespace {

using nlohmann::ordered_json;

ordered_json switch_json(WristSwitch position) {
  if (position == WristSwitch::unknown) return nullptr;
  return position == WristSwitch::on ? "on" : "off";
}

} // namespace

ordered_json sensors_json(SensorMask sensors) {
  ordered_json names = ordered_json::array();
  for (const Sensor sensor : sensors)
    names.push_back(name_of(sensor));
  return names;
}

ordered_json angle_sources_json(SensorMask sensors, SensorMask left_out) {
  const hand::AngleSources sources = hand::angle_sources(sensors, left_out);
  ordered_json by_angle = ordered_json::object();
  for (std::size_t n = 0; n < hand::angle_count; ++n)
    by_angle[std::string(hand::angle_names[n])] = name_of(sources[n]);
  return by_angle;
}

void add_counts(ordered_json& object, const driver::RecordCounts& counts) {
  for (const auto& [name, count] : driver::by_name(counts)) {
    ordered_json& value = object[std::string(name)];
    if (count) value = *count; // otherwise null: not known
  }
}

std::string sample_json(const GloveSample& sample, const hand::Calibration* calibration,
                        bool with_sources, const sculpting::FoundCalibration* found,
                        SensorMask left_out) {
  ordered_json raw = ordered_json::object();
  ordered_json angles = ordered_json::object();
  const auto angles_rad = calibration != nullptr
                              ? hand::filled_angles_rad(sample, *calibration, left_out)
                              : hand::SensorAngles{};
  for (const Sensor sensor : sample.present) {
    const std::size_t slot = index_of(sensor);
    const std::string name(name_of(sensor));
    raw[name] = sample[sensor].value;
    if (calibration != nullptr && (*calibration)[sensor].gain_rad_per_count != 0.0)
      angles[name] = angles_rad[slot];
  }
  const HostTime came = sample.is_replayed ? sample.recorded_arrival : sample.arrival;
  const HostTime taken = sample.is_replayed ? sample.recorded_measured : sample.measured;
  ordered_json line{{"time_s", to_seconds(came.time_since_epoch())},
                    {"measured_s", to_seconds(taken.time_since_epoch())},
                    {"sequence", sample.sequence},
                    {"hand", name_of(sample.side)},
                    {"switch", switch_json(sample.wrist_switch)},
                    {"raw", std::move(raw)}};
  if (sample.is_replayed) line["replayed_s"] = to_seconds(sample.arrival.time_since_epoch());
  if (sample.has_device_time) line["device_time_s"] = to_seconds(sample.device_time);
  if (calibration != nullptr) line["angle_rad"] = std::move(angles);
  if (left_out.bits != 0) line["left_out"] = sensors_json(left_out);
  if (calibration != nullptr && with_sources)
    line["angles"] = angle_sources_json(sample.present, left_out);
  if (calibration != nullptr && with_sources && found != nullptr)
    line["calibration"] = calibration_json(*found);
  return cli::json_text(line);
}

ordered_json calibration_json(const sculpting::FoundCalibration& found) {
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? ordered_json() : ordered_json(text);
  };
  return {{"kind", name_of(found.kind)},
          {"user", text_or_null(found.user)},
          {"path", text_or_null(found.path.string())}};
}

} // namespace nendo::gloves
