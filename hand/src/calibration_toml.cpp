#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_file.hpp>

#include "calibration_check.hpp"
#include "config/toml_reader.hpp"

namespace nendo::hand {

using config::TomlReader;

namespace {

void complain_if(TomlReader& reader, const toml::node& where, const std::string& subject,
                 const std::string& complaint) {
  if (!complaint.empty()) reader.complain(where, subject + ": " + complaint);
}

/// nullopt, with a complaint, if no sensor has that name.
std::optional<Sensor> read_sensor_name(TomlReader& reader, const toml::node& where,
                                       std::string_view name) {
  const auto sensor = sensor_named(name);
  if (!sensor)
    reader.complain(where, "no sensor is called " + in_quotes(name) +
                               "; use the names that `nendo info` shows");
  return sensor;
}

void read_sensor(TomlReader& reader, Sensor sensor, const toml::node& node,
                 WearerCalibration& wearer) {
  const std::string name(name_of(sensor));
  const toml::table* table = node.as_table();
  if (table == nullptr)
    return reader.complain(node,
                           name + " must be { gain_rad_per_count = ..., offset_counts = ... }");
  reader.allow_only(*table, {"gain_rad_per_count", "offset_counts", "residual_rad", "least_counts",
                             "most_counts", "confidence"});
  const SensorCalibration line{reader.number(*table, "gain_rad_per_count"),
                               reader.number(*table, "offset_counts")};
  complain_if(reader, node, name, complaint_about(sensor, line, wearer.counts));
  wearer.calibration[sensor] = line;
  if (table->size() <= 2) return;
  const SensorQuality quality{
      reader.number(*table, "residual_rad"), reader.number(*table, "least_counts"),
      reader.number(*table, "most_counts"), reader.number(*table, "confidence")};
  complain_if(reader, node, name, complaint_about(quality));
  wearer.quality[index_of(sensor)] = quality;
}

void read_sensors(TomlReader& reader, const toml::table& root, WearerCalibration& wearer) {
  const toml::table* sensors = reader.table(root, "sensors");
  if (sensors == nullptr || reader.error()) return;
  SensorMask seen; // the older name of a sensor is another key
  for (const auto& [key, node] : *sensors) {
    const auto sensor = read_sensor_name(reader, node, key.str());
    if (!sensor) continue;
    if (seen.has(*sensor))
      reader.complain(node, std::string(name_of(*sensor)) + " is here twice; leave one out");
    seen.add(*sensor);
    read_sensor(reader, *sensor, node, wearer);
  }
}

void read_coupling(TomlReader& reader, const toml::node& node, WearerCalibration& wearer,
                   std::array<bool, couplings.size()>& seen) {
  const toml::table* table = node.as_table();
  if (table == nullptr)
    return reader.complain(node, "mixed_in must hold { of = ..., by = ..., rad_per_rad = ... }");
  reader.allow_only(*table, {"of", "by", "rad_per_rad"});
  const std::string of = reader.text(*table, "of");
  const std::string by = reader.text(*table, "by");
  const double rad_per_rad = reader.number(*table, "rad_per_rad");
  complain_if(reader, node, "mixed_in", complaint_about_coupling(rad_per_rad));
  for (std::size_t k = 0; k < couplings.size(); ++k) {
    if (sensor_named(of) != couplings[k].of || sensor_named(by) != couplings[k].by) continue;
    if (std::exchange(seen[k], true)) break;
    wearer.calibration.coupling_gains[k] = rad_per_rad;
    return;
  }
  reader.complain(node, "mixed_in: nothing of " + in_quotes(by) + " is mixed into " +
                            in_quotes(of) + " (or it is here twice); leave it out");
}

void read_mixed_in(TomlReader& reader, const toml::table& root, WearerCalibration& wearer) {
  const toml::node* node = root.get("mixed_in");
  if (node == nullptr) return;
  const toml::array* list = node->as_array();
  if (list == nullptr) return reader.complain(*node, "mixed_in must be a list in brackets");
  std::array<bool, couplings.size()> seen{};
  for (const toml::node& entry : *list)
    read_coupling(reader, entry, wearer, seen);
}

/// Older files have no left_out.
void read_left_out(TomlReader& reader, const toml::table& root, WearerCalibration& wearer) {
  const toml::node* node = root.get("left_out");
  if (node == nullptr) return;
  const toml::array* list = node->as_array();
  if (list == nullptr)
    return reader.complain(*node, "left_out must be a list of sensors, as [\"index_pip\"]");
  for (const toml::node& entry : *list) {
    const auto name = entry.value_exact<std::string>();
    if (!name) return reader.complain(entry, "left_out: each sensor must be a name in quotes");
    const auto sensor = read_sensor_name(reader, entry, *name);
    if (!sensor) return;
    if (wearer.calibration[*sensor].gain_rad_per_count != 0.0)
      return reader.complain(entry,
                             *name + " is in left_out and in [sensors]; keep it in one of them");
    wearer.left_out.add(*sensor);
  }
}

void read_glove(TomlReader& reader, const toml::table& root, WearerCalibration& wearer) {
  const toml::table* glove = reader.table(root, "glove");
  if (glove == nullptr) return;
  reader.allow_only(*glove, {"model", "serial", "counts_most", "whole_range"});
  wearer.glove_model = reader.text(*glove, "model");
  complain_if(reader, *glove, "glove model", complaint_about_text(wearer.glove_model, true));
  wearer.glove_serial = reader.text(*glove, "serial");
  complain_if(reader, *glove, "glove serial", complaint_about_text(wearer.glove_serial, true));
  wearer.counts.max_count =
      static_cast<std::uint16_t>(reader.count(*glove, "counts_most", 65535, 1));
  wearer.counts.self_calibrated = reader.truth(*glove, "whole_range");
}

/// Without hand_shape the hand is an average one.
void read_shape(TomlReader& reader, const toml::table& root, WearerShape& shape) {
  if (root.get("hand_shape") == nullptr) return;
  const toml::table* table = reader.table(root, "hand_shape");
  if (table == nullptr) return;
  for (const auto& [key, node] : *table) {
    const auto* const known =
        std::find(shape_term_names.begin(), shape_term_names.end(), key.str());
    if (known == shape_term_names.end())
      return reader.complain(node, "hand_shape has no " + in_quotes(key.str()) + "; leave it out");
    shape.terms[static_cast<std::size_t>(known - shape_term_names.begin())] =
        reader.number(*table, key.str());
  }
}

void read_hand(TomlReader& reader, const toml::table& root, WearerCalibration& wearer) {
  const std::string hand = reader.text(root, "hand");
  const auto side = side_named(hand);
  if (!side)
    complain_if(reader, root["hand"].node() != nullptr ? *root["hand"].node() : root,
                "hand " + in_quotes(hand), "must be \"left\" or \"right\"");
  wearer.side = side.value_or(Side::right);
  const toml::table* size = reader.table(root, "hand_size");
  if (size == nullptr) return;
  reader.allow_only(*size, {"length_m", "breadth_m"});
  wearer.size.length_m = reader.number(*size, "length_m");
  wearer.size.breadth_m = reader.number(*size, "breadth_m");
  read_shape(reader, root, wearer.size.shape);
  complain_if(reader, *size, "hand_size", complaint_about(wearer.size));
}

void read_wearer(TomlReader& reader, const toml::table& root, WearerCalibration& wearer) {
  reader.allow_only(root, {"version", "user", "hand", "made", "method", "middle_bias", "mixed_in",
                           "left_out", "glove", "hand_size", "hand_shape", "sensors"});
  wearer.user = reader.text(root, "user");
  complain_if(reader, root, "user", complaint_about_text(wearer.user, false));
  wearer.method = reader.text(root, "method");
  complain_if(reader, root, "method", complaint_about_text(wearer.method, false));
  wearer.made = reader.time(root, "made");
  wearer.calibration.middle_bias = reader.number(root, "middle_bias");
  complain_if(reader, root, "middle_bias", complaint_about_bias(wearer.calibration.middle_bias));
  read_mixed_in(reader, root, wearer);
  read_glove(reader, root, wearer);
  read_hand(reader, root, wearer);
  read_sensors(reader, root, wearer);
  read_left_out(reader, root, wearer);
}

} // namespace

Result<WearerCalibration> parse_calibration(std::string_view text, std::string_view name) {
  WearerCalibration wearer;
  const auto error = config::read_toml(
      text, name,
      [&](TomlReader& reader, const toml::table& root) { read_wearer(reader, root, wearer); },
      "fix it or calibrate again");
  if (error) return *error;
  return wearer;
}

} // namespace nendo::hand
