#include "gloves/glove_json.hpp"

#include <utility>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/joint_angles.hpp>

#include "cli/cli.hpp"

namespace nendo::gloves {

using nlohmann::ordered_json;

ordered_json switch_json(WristSwitch position) {
  if (position == WristSwitch::unknown) return nullptr;
  return position == WristSwitch::on ? "on" : "off";
}

ordered_json sensors_json(SensorMask sensors) {
  ordered_json names = ordered_json::array();
  for (const Sensor sensor : sensors)
    names.push_back(name_of(sensor));
  return names;
}

ordered_json glove_json(const driver::GloveInfo& info) {
  ordered_json facts = ordered_json::object();
  for (const auto& [name, value] : info.facts)
    facts[name] = value;
  const driver::Abilities& can = info.abilities;
  return {
      {"source", info.source},
      {"model", info.model},
      {"hand", name_of(info.side)},
      {"sensors", sensors_json(info.sensors)},
      {"angles", angle_sources_json(info.sensors)},
      {"rate_hz", info.rate_hz},
      {"counts", {{"most", info.counts.max_count}, {"whole_range", info.counts.self_calibrated}}},
      {"abilities",
       {{"wrist_switch", can.wrist_switch},
        {"light", can.light},
        {"vibration", can.vibration},
        {"resistance", can.resistance}}},
      {"facts", std::move(facts)}};
}

ordered_json joints_json(const hand::HandPose& pose) {
  ordered_json joints = ordered_json::object();
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    const Eigen::Isometry3d& joint = pose.joints[at];
    const Eigen::Vector3d position = joint.translation();
    Eigen::Quaterniond q(joint.linear());
    q.normalize();
    if (q.w() < 0.0) q.coeffs() = -q.coeffs(); // both are the same turn
    joints[std::string(name_of(static_cast<hand::Joint>(at)))] = {
        {"position_m", {position.x(), position.y(), position.z()}},
        {"orientation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
  }
  return joints;
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
