#include "served/served_lines.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/base/text.hpp>

#include "served/served_protocol.hpp"

namespace nendo::driver::served {
namespace {

/// Keeps the order of keys, in which facts are shown.
using Json = nlohmann::ordered_json;

Json parse_bounded(std::string_view text) {
  std::size_t values = 0;
  bool is_within = true;
  const auto watch = [&](int depth, Json::parse_event_t, Json&) {
    is_within = is_within && depth <= max_depth && ++values <= max_values;
    return is_within;
  };
  Json parsed = Json::parse(text.begin(), text.end(), watch, false);
  return is_within ? parsed : Json();
}

// The functions below return false if the value is not of that type, or out of range.

bool read(const Json& value, bool& out) {
  if (!value.is_boolean()) return false;
  out = value.get<bool>();
  return true;
}

bool read(const Json& value, std::string& out) {
  if (!value.is_string()) return false;
  out = printable(value.get_ref<const std::string&>());
  return true;
}

bool read(const Json& value, double& out) {
  if (!value.is_number()) return false;
  out = value.get<double>();
  return std::isfinite(out);
}

bool read(const Json& value, std::uint64_t& out) {
  if (!value.is_number_unsigned()) return false;
  out = value.get<std::uint64_t>();
  return true;
}

bool read(const Json& value, std::int64_t& out) {
  if (value.is_number_unsigned() &&
      value.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()})
    return false;
  if (!value.is_number_integer()) return false; // or unsigned
  out = value.get<std::int64_t>();
  return true;
}

bool read(const Json& value, std::uint16_t& out) {
  std::uint64_t number = 0;
  if (!read(value, number) || number > std::numeric_limits<std::uint16_t>::max()) return false;
  out = static_cast<std::uint16_t>(number);
  return true;
}

bool read(const Json& value, std::chrono::nanoseconds& out) {
  std::int64_t number = 0;
  if (!read(value, number)) return false;
  out = std::chrono::nanoseconds(number);
  return out >= -max_time && out <= max_time;
}

bool read(const Json& value, HostTime& out) {
  std::chrono::nanoseconds since_zero{};
  if (!read(value, since_zero)) return false;
  out = HostTime(since_zero);
  return true;
}

bool read(const Json& value, Side& out) {
  const auto side =
      value.is_string() ? side_named(value.get_ref<const std::string&>()) : std::optional<Side>{};
  if (side) out = *side;
  return side.has_value();
}

bool read(const Json& value, SourceKind& out) {
  const auto kind =
      value.is_string()
          ? enumerator_named<SourceKind>(source_kind_names, value.get_ref<const std::string&>())
          : std::optional<SourceKind>{};
  if (kind) out = *kind;
  return kind.has_value();
}

bool read(const Json& value, WristSwitch& out) {
  if (value.is_null()) return true;
  if (!value.is_string()) return false;
  const std::string& text = value.get_ref<const std::string&>();
  out = text == "on" ? WristSwitch::on : WristSwitch::off;
  return text == "on" || text == "off";
}

/// A letter of a device; null: none.
bool read(const Json& value, char& out) {
  if (value.is_null()) return true;
  std::string text;
  if (!read(value, text) || text.size() != 1) return false;
  out = text.front();
  return true;
}

template <std::size_t count>
bool read(const Json& value, std::array<double, count>& out) {
  if (!value.is_array() || value.size() != count) return false;
  for (std::size_t at = 0; at < count; ++at)
    if (!read(value[at], out[at])) return false;
  return true;
}

bool read(const Json& value, std::vector<std::uint16_t>& out) {
  if (!value.is_array()) return false;
  for (const Json& item : value)
    if (!read(item, out.emplace_back())) return false;
  return true;
}

bool read(const Json& value, std::vector<DeviceFact>& out) {
  if (!value.is_object()) return false;
  for (const auto& [name, fact] : value.items())
    if (!read(fact, out.emplace_back(DeviceFact{printable(name), {}}).value)) return false;
  return true;
}

std::optional<Sensor> sensor_named(std::string_view name) noexcept {
  return enumerator_named<Sensor>(sensor_names, name);
}

bool read(const Json& value, SensorMask& out) {
  if (!value.is_array()) return false;
  for (const Json& item : value) {
    if (!item.is_string()) return false;
    if (const auto sensor = sensor_named(item.get_ref<const std::string&>())) out.add(*sensor);
  }
  return true;
}

bool read_counts(const Json& value, GloveSample& out) {
  if (!value.is_object()) return false;
  for (const auto& [name, count] : value.items()) {
    std::uint16_t number = 0;
    if (!read(count, number)) return false;
    if (const auto sensor = sensor_named(name)) out.set(*sensor, RawCount{number});
  }
  return true;
}

bool read_index(const Json& value, std::uint32_t& out) {
  std::uint64_t number = 0;
  if (!read(value, number) || number > max_index) return false;
  out = static_cast<std::uint32_t>(number);
  return true;
}

const Json* member(const Json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found == object.end() ? nullptr : &*found;
}

/// Reads the member of that key. Returns false if it is missing or wrong.
template <class Value>
bool take(const Json& object, const char* key, Value& out) {
  const Json* const value = member(object, key);
  return value != nullptr && read(*value, out);
}

/// Does the same, but a missing member leaves `out` as it is.
template <class Value>
bool take_any(const Json& object, const char* key, Value& out) {
  return member(object, key) == nullptr || take(object, key, out);
}

std::optional<Line> decode_version(const Json& object) {
  VersionLine line;
  if (!take(object, "protocol", line.protocol) || !take(object, "version", line.version))
    return std::nullopt;
  return line;
}

std::optional<Line> decode_glove(const Json& object) {
  GloveLine line;
  GloveInfo& info = line.info;
  const Json* const index = member(object, "index");
  const Json* const counts = member(object, "counts");
  const Json* const abilities = member(object, "abilities");
  const bool is_good = index != nullptr && counts != nullptr && abilities != nullptr &&
                       read_index(*index, line.index) && take(object, "side", line.side) &&
                       take(object, "source", info.source) && take(object, "model", info.model) &&
                       take(object, "hand", info.side) && take(object, "sensors", info.sensors) &&
                       take(object, "rate_hz", info.rate_hz) && info.rate_hz >= 0.0 &&
                       take(*counts, "most", info.counts.max_count) && info.counts.max_count > 0 &&
                       take(*counts, "whole_range", info.counts.self_calibrated) &&
                       take(*abilities, "wrist_switch", info.abilities.wrist_switch) &&
                       take(object, "facts", info.facts) && take(object, "kind", info.kind) &&
                       take_any(object, "recording", info.recording);
  if (!is_good) return std::nullopt;
  return line;
}

bool is_turn(const std::array<double, 4>& turn_xyzw) noexcept {
  constexpr double max_error = 0.01; // of the square of its length
  double squares = 0.0;
  for (const double part : turn_xyzw)
    squares += part * part;
  return std::abs(squares - 1.0) <= max_error;
}

std::optional<Line> decode_tracker(const Json& object) {
  TrackerLine line;
  TrackerInfo& info = line.info;
  const Json* const index = member(object, "index");
  const bool is_good = index != nullptr && read_index(*index, line.index) &&
                       take(object, "side", line.side) && take(object, "source", info.source) &&
                       take(object, "model", info.model) && take(object, "station", line.station) &&
                       take(object, "stations", info.stations) && !info.stations.empty() &&
                       take(object, "rate_hz", info.rate_hz) && info.rate_hz >= 0.0 &&
                       take(object, "filtered", info.is_filtered) &&
                       take(object, "stage_from_tracker_xyzw", info.stage_from_tracker_xyzw) &&
                       is_turn(info.stage_from_tracker_xyzw) && take(object, "facts", info.facts) &&
                       take(object, "kind", info.kind);
  if (!is_good) return std::nullopt;
  return line;
}

/// Reads what samples and poses have in common.
template <class Sample>
bool take_times(const Json& object, Sample& sample, std::uint64_t& dropped) {
  sample.has_device_time = member(object, "device_time_ns") != nullptr;
  sample.is_replayed = member(object, "recorded_arrival_ns") != nullptr;
  return take(object, "sequence", sample.sequence) && take(object, "arrival_ns", sample.arrival) &&
         take(object, "measured_ns", sample.measured) &&
         take_any(object, "device_time_ns", sample.device_time) &&
         take_any(object, "recorded_arrival_ns", sample.recorded_arrival) &&
         (!sample.is_replayed || take(object, "recorded_measured_ns", sample.recorded_measured)) &&
         take_any(object, "dropped", dropped);
}

std::optional<Line> decode_sample(const Json& object) {
  SampleLine line;
  GloveSample& sample = line.sample;
  const Json* const glove = member(object, "glove");
  const Json* const raw = member(object, "raw");
  const bool is_good =
      glove != nullptr && raw != nullptr && read_index(*glove, line.glove) &&
      take_times(object, sample, line.dropped) && take(object, "hand", sample.side) &&
      take_any(object, "switch", sample.wrist_switch) &&
      take_any(object, "sampled_too_fast", sample.sampled_too_fast) && read_counts(*raw, sample);
  if (!is_good) return std::nullopt;
  return line;
}

std::optional<Line> decode_pose(const Json& object) {
  PoseLine line;
  PoseSample& pose = line.pose;
  const Json* const tracker = member(object, "tracker");
  const bool is_good =
      tracker != nullptr && read_index(*tracker, line.tracker) &&
      take_times(object, pose, line.dropped) && take_any(object, "station", pose.station) &&
      take(object, "position_m", pose.position_m) && take(object, "turn_xyzw", pose.turn_xyzw) &&
      take_any(object, "error", pose.error);
  if (!is_good) return std::nullopt;
  return line;
}

std::optional<Line> decode_watch(const Json& object) {
  WatchLine line;
  if (!take(object, "samples", line.samples)) return std::nullopt;
  return line;
}

std::optional<Line> decode_error(const Json& object) {
  ErrorLine line;
  if (!take(object, "message", line.message)) return std::nullopt;
  return line;
}

struct LineClass {
  std::string_view name;
  std::optional<Line> (*decode)(const Json& object);
};
constexpr std::array line_classes{
    LineClass{"SAMPLE", decode_sample}, LineClass{"POSE", decode_pose},
    LineClass{"WATCH", decode_watch},   LineClass{"VERSION", decode_version},
    LineClass{"GLOVE", decode_glove},   LineClass{"TRACKER", decode_tracker},
    LineClass{"ERROR", decode_error},
};

} // namespace

std::optional<Line> decode_line(std::string_view text) {
  const Json object = parse_bounded(text);
  std::string name;
  if (!take(object, "class", name)) return std::nullopt;
  for (const LineClass& known : line_classes)
    if (known.name == name) return known.decode(object);
  return OtherLine{};
}

} // namespace nendo::driver::served
