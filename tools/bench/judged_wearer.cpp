#include "bench/judged_wearer.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace nendo::bench {
namespace judged_file {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 5> digits{"none", "index", "middle", "ring", "little"};

Json counts_json(const CountRow& row, SensorMask sensors) {
  Json counts = Json::array();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (sensors.has(static_cast<Sensor>(slot))) counts.push_back(row[slot]);
  return counts;
}

Json session_json(const JudgedSession& session, SensorMask sensors) {
  Json takes = Json::array(), motion = Json::array();
  for (const hand::PoseReading& take : session.takes) {
    Json counts = Json::array();
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      if (sensors.has(static_cast<Sensor>(slot)))
        counts.push_back(std::round(100.0 * take.held.mean_counts[slot]) / 100.0);
    takes.push_back({{"pose", hand::pose_of(take.pose).name}, {"mean_counts", counts}});
  }
  for (const JudgedMoment& moment : session.motion) {
    Json angles = Json::array();
    for (const double angle : moment.angles_deg)
      angles.push_back(std::round(100.0 * angle) / 100.0);
    motion.push_back({{"counts", counts_json(moment.counts, sensors)},
                      {"angles_deg", angles},
                      {"touching", digits[static_cast<std::size_t>(moment.touching)]}});
  }
  Json free_motion = Json::array();
  for (const CountRow& row : session.free_motion)
    free_motion.push_back(counts_json(row, sensors));
  return {{"free_motion", free_motion}, {"takes", takes}, {"motion", motion}};
}

/// What a line says that cannot be.
struct Wrong {
  std::string what;
};

double number(const Json& value, double least, double most, const char* what) {
  if (!value.is_number()) throw Wrong{std::string(what) + ": not a number"};
  const double number = value.get<double>();
  if (!(number >= least && number <= most))
    throw Wrong{std::string(what) + ": not from " + std::to_string(least) + " to " +
                std::to_string(most)};
  return number;
}

const Json& list(const Json& object, const char* key, std::size_t most) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_array())
    throw Wrong{std::string("no list \"") + key + "\""};
  if (object[key].size() > most) throw Wrong{std::string("\"") + key + "\" is too long"};
  return object[key];
}

std::array<double, sensor_slots> counts_of(const Json& values, SensorMask sensors) {
  std::array<double, sensor_slots> counts{};
  std::size_t at = 0;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors.has(static_cast<Sensor>(slot))) continue;
    if (at >= values.size()) throw Wrong{"fewer counts than sensors"};
    counts[slot] = number(values[at++], 0.0, 255.0, "counts");
  }
  if (at != values.size()) throw Wrong{"more counts than sensors"};
  return counts;
}

CountRow row_of(const Json& values, SensorMask sensors) {
  if (!values.is_array()) throw Wrong{"counts: not a list"};
  CountRow row{};
  const auto counts = counts_of(values, sensors);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    row[slot] = static_cast<std::uint16_t>(std::lround(counts[slot]));
  return row;
}

std::string text_of(const Json& object, const char* key) {
  if (!object.contains(key) || !object[key].is_string())
    throw Wrong{std::string("no text \"") + key + "\""};
  return object[key].get<std::string>();
}

JudgedSession session_of(const Json& object, SensorMask sensors, bool is_again) {
  JudgedSession session;
  const bool moves = !is_again || (object.is_object() && object.contains("free_motion"));
  if (moves)
    for (const Json& row : list(object, "free_motion", 1'000'000))
      session.free_motion.push_back(row_of(row, sensors));
  for (const Json& take : list(object, "takes", 1000)) {
    const auto pose = hand::pose_named(text_of(take, "pose"));
    if (!pose) throw Wrong{"no pose is called \"" + text_of(take, "pose") + "\""};
    hand::PoseReading reading{*pose, {}};
    reading.held.present = sensors;
    reading.held.mean_counts = counts_of(list(take, "mean_counts", sensor_slots), sensors);
    session.takes.push_back(reading);
  }
  for (const Json& entry : list(object, "motion", 1'000'000)) {
    JudgedMoment moment;
    moment.counts = row_of(list(entry, "counts", sensor_slots), sensors);
    const Json& angles = list(entry, "angles_deg", hand::angle_count);
    if (angles.size() != hand::angle_count)
      throw Wrong{"angles_deg: not " + std::to_string(hand::angle_count) + " angles"};
    for (std::size_t n = 0; n < hand::angle_count; ++n)
      moment.angles_deg[n] = number(angles[n], -360.0, 360.0, "angles_deg");
    const std::string touching = entry.contains("touching") ? text_of(entry, "touching") : "none";
    for (std::size_t n = 0; n < digits.size(); ++n)
      if (touching == digits[n]) moment.touching = static_cast<int>(n);
    session.motion.push_back(moment);
  }
  return session;
}

JudgedWearer wearer_of(const Json& object) {
  if (!object.is_object()) throw Wrong{"not a JSON object"};
  JudgedWearer wearer;
  wearer.name = text_of(object, "name");
  const auto side = side_named(text_of(object, "hand"));
  if (!side) throw Wrong{"\"hand\" is neither left nor right"};
  wearer.side = *side;
  for (const Json& name : list(object, "sensors", sensor_slots)) {
    if (!name.is_string()) throw Wrong{"sensors: not a list of names"};
    const auto sensor = sensor_named(name.get<std::string>());
    if (!sensor) throw Wrong{"no sensor is called " + name.dump()};
    wearer.sensors.add(*sensor);
  }
  const Json& pads = list(object, "pads_mm", 5);
  if (pads.size() != 5) throw Wrong{"pads_mm: not five pads"};
  for (std::size_t n = 0; n < 5; ++n) {
    if (!pads[n].is_array() || pads[n].size() != 2)
      throw Wrong{"pads_mm: not a depth and a distance behind"};
    wearer.pads[n] = {1e-3 * number(pads[n][0], -50.0, 50.0, "pads_mm"),
                      1e-3 * number(pads[n][1], -50.0, 50.0, "pads_mm")};
  }
  wearer.fresh = session_of(object, wearer.sensors, false);
  if (object.contains("again")) wearer.again = session_of(object["again"], wearer.sensors, true);
  return wearer;
}

} // namespace
} // namespace judged_file

std::string line_of(const JudgedWearer& wearer) {
  using judged_file::Json;
  Json sensors = Json::array(), pads = Json::array();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (wearer.sensors.has(static_cast<Sensor>(slot))) sensors.push_back(sensor_names[slot]);
  for (const JudgedWearer::Pad& pad : wearer.pads)
    pads.push_back(Json::array(
        {std::round(1e5 * pad.depth_m) / 100.0, std::round(1e5 * pad.behind_m) / 100.0}));
  Json object{{"name", wearer.name},
              {"hand", wearer.side == Side::left ? "left" : "right"},
              {"sensors", sensors},
              {"pads_mm", pads}};
  object.update(judged_file::session_json(wearer.fresh, wearer.sensors));
  if (!wearer.again.takes.empty())
    object["again"] = judged_file::session_json(wearer.again, wearer.sensors);
  return object.dump() + "\n";
}

Result<JudgedWearers> JudgedWearers::open(const std::filesystem::path& path) {
  JudgedWearers wearers;
  wearers.name_ = path.string();
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) wearers.file_.open(path);
  if (!wearers.file_.is_open())
    return Error{Errc::bad_input,
                 wearers.name_ + ": cannot be read; `nendo bench wearers --out FILE` makes one"};
  return wearers;
}

Result<std::optional<JudgedWearer>> JudgedWearers::next() {
  std::string text;
  if (!std::getline(file_, text)) return std::optional<JudgedWearer>();
  ++line_;
  const auto wrong = [&](const std::string& what) {
    return Error{Errc::bad_input, name_ + ":" + std::to_string(line_) + ": " + what};
  };
  const auto object = judged_file::Json::parse(text, nullptr, false);
  if (object.is_discarded()) return wrong("not a JSON object");
  try {
    return std::optional<JudgedWearer>(judged_file::wearer_of(object));
  } catch (const judged_file::Wrong& caught) {
    return wrong(caught.what);
  } catch (const nlohmann::json::exception&) {
    return wrong("not a wearer; see `nendo bench wearers --out FILE`");
  }
}

} // namespace nendo::bench
