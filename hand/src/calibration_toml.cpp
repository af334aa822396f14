// Reading calibration files. toml++ stays in this source file.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <utility>

#include <toml++/toml.h>

#include <nendo/base/plain_toml.hpp>
#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_file.hpp>

#include "calibration_check.hpp"

namespace nendo::hand {
namespace {

/// Takes tables apart and keeps the first complaint; after it, values are blank.
class Reader {
public:
  explicit Reader(std::string_view name) : name_(name) {}

  const std::optional<Error>& error() const noexcept { return error_; }
  void complain(const toml::node& where, const std::string& what) {
    if (!error_) error_ = bad_line(name_, where.source().begin.line, what);
  }
  /// Complains unless `complaint` is empty.
  void check(const toml::node& where, const std::string& subject, const std::string& complaint) {
    if (!complaint.empty()) complain(where, subject + ": " + complaint);
  }

  void allow_only(const toml::table& table, std::initializer_list<std::string_view> keys);
  /// Null, with a complaint, if it is missing.
  const toml::node* find(const toml::table& table, std::string_view key);
  const toml::table* table(const toml::table& table, std::string_view key);
  std::string text(const toml::table& table, std::string_view key);
  double number(const toml::table& table, std::string_view key);
  bool truth(const toml::table& table, std::string_view key);
  /// 0 unless the number lies within 0 and 65535.
  std::uint16_t count(const toml::table& table, std::string_view key);
  std::chrono::sys_seconds time(const toml::table& table, std::string_view key);
  /// nullopt, with a complaint, if no sensor has that name.
  std::optional<Sensor> sensor(const toml::node& where, std::string_view sensor_name);

private:
  std::string name_;
  std::optional<Error> error_;
};

void Reader::allow_only(const toml::table& table, std::initializer_list<std::string_view> keys) {
  for (const auto& [key, node] : table) {
    if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
    std::string known;
    for (const auto& name : keys)
      known.append(known.empty() ? "" : ", ").append(name);
    complain(node, "unknown key " + in_quotes(key.str()) + "; there are " + known);
  }
}

const toml::node* Reader::find(const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) complain(table, "has no " + std::string(key) + "; add it");
  return node;
}

const toml::table* Reader::table(const toml::table& table, std::string_view key) {
  const toml::node* node = find(table, key);
  if (node == nullptr) return nullptr;
  if (!node->is_table())
    complain(*node, std::string(key) + " must be a table, as [" + std::string(key) + "]");
  return node->as_table();
}

std::string Reader::text(const toml::table& table, std::string_view key) {
  const toml::node* node = find(table, key);
  if (node == nullptr) return {};
  const auto value = node->value_exact<std::string>();
  if (!value) complain(*node, std::string(key) + " must be a text in quotes");
  return value.value_or("");
}

double Reader::number(const toml::table& table, std::string_view key) {
  const toml::node* node = find(table, key);
  if (node == nullptr) return 0.0;
  const auto value = node->value<double>();
  if (!node->is_number() || !value || !std::isfinite(*value)) {
    complain(*node, std::string(key) + " must be a finite number");
    return 0.0;
  }
  return *value;
}

bool Reader::truth(const toml::table& table, std::string_view key) {
  const toml::node* node = find(table, key);
  if (node == nullptr) return false;
  const auto value = node->value_exact<bool>();
  if (!value) complain(*node, std::string(key) + " must be true or false");
  return value.value_or(false);
}

std::uint16_t Reader::count(const toml::table& table, std::string_view key) {
  const toml::node* node = find(table, key);
  if (node == nullptr) return 0;
  const auto value = node->value_exact<std::int64_t>();
  if (value && *value >= 1 && *value <= 65535) return static_cast<std::uint16_t>(*value);
  complain(*node, std::string(key) + " must be a whole number within 1 and 65535");
  return 0;
}

std::chrono::sys_seconds Reader::time(const toml::table& table, std::string_view key) {
  using namespace std::chrono;
  const toml::node* node = find(table, key);
  if (node == nullptr) return {};
  const auto value = node->value_exact<toml::date_time>();
  if (!value || !value->offset) {
    complain(*node, std::string(key) + " must be a date and time with zone, "
                                       "as 2026-11-21T19:27:05Z, without quotes");
    return {};
  }
  const sys_days day = year{value->date.year} / int{value->date.month} / int{value->date.day};
  const sys_seconds moment = day + hours{value->time.hour} + minutes{value->time.minute} +
                             seconds{value->time.second} - minutes{value->offset->minutes};
  if (moment < sys_seconds{} || moment >= sys_days{year{10000} / 1 / 1})
    complain(*node, std::string(key) + " must lie within the years 1970 and 9999");
  return moment;
}

std::optional<Sensor> Reader::sensor(const toml::node& where, std::string_view sensor_name) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (sensor_names[slot] == sensor_name) return static_cast<Sensor>(slot);
  }
  complain(where, "no sensor is called " + in_quotes(sensor_name) +
                      "; use the names that `nendo info` shows");
  return std::nullopt;
}

void read_sensor(Reader& reader, Sensor sensor, const toml::node& node, WearerCalibration& wearer) {
  const std::string name(name_of(sensor));
  const toml::table* table = node.as_table();
  if (table == nullptr)
    return reader.complain(node,
                           name + " must be { gain_rad_per_count = ..., offset_counts = ... }");
  reader.allow_only(*table, {"gain_rad_per_count", "offset_counts", "residual_rad", "least_counts",
                             "most_counts", "confidence"});
  const SensorCalibration line{reader.number(*table, "gain_rad_per_count"),
                               reader.number(*table, "offset_counts")};
  reader.check(node, name, complaint_about(sensor, line, wearer.counts));
  wearer.calibration[sensor] = line;
  if (table->size() <= 2) return;
  const SensorQuality quality{
      reader.number(*table, "residual_rad"), reader.number(*table, "least_counts"),
      reader.number(*table, "most_counts"), reader.number(*table, "confidence")};
  reader.check(node, name, complaint_about(quality));
  wearer.quality[static_cast<std::size_t>(sensor)] = quality;
}

void read_sensors(Reader& reader, const toml::table& root, WearerCalibration& wearer) {
  const toml::table* sensors = reader.table(root, "sensors");
  if (sensors == nullptr || reader.error()) return;
  for (const auto& [key, node] : *sensors) {
    if (const auto sensor = reader.sensor(node, key.str()))
      read_sensor(reader, *sensor, node, wearer);
  }
}

void read_coupling(Reader& reader, const toml::node& node, WearerCalibration& wearer,
                   std::array<bool, couplings.size()>& seen) {
  const toml::table* table = node.as_table();
  if (table == nullptr)
    return reader.complain(node, "mixed_in must hold { of = ..., by = ..., rad_per_rad = ... }");
  reader.allow_only(*table, {"of", "by", "rad_per_rad"});
  const std::string of = reader.text(*table, "of");
  const std::string by = reader.text(*table, "by");
  const double rad_per_rad = reader.number(*table, "rad_per_rad");
  reader.check(node, "mixed_in", complaint_about_coupling(rad_per_rad));
  for (std::size_t k = 0; k < couplings.size(); ++k) {
    if (name_of(couplings[k].of) != of || name_of(couplings[k].by) != by) continue;
    if (std::exchange(seen[k], true)) break;
    wearer.calibration.coupling_gains[k] = rad_per_rad;
    return;
  }
  reader.complain(node, "mixed_in: nothing of " + in_quotes(by) + " is mixed into " +
                            in_quotes(of) + " (or it stands here twice); leave it out");
}

void read_mixed_in(Reader& reader, const toml::table& root, WearerCalibration& wearer) {
  const toml::node* node = root.get("mixed_in");
  if (node == nullptr) return;
  const toml::array* list = node->as_array();
  if (list == nullptr) return reader.complain(*node, "mixed_in must be a list in brackets");
  std::array<bool, couplings.size()> seen{};
  for (const toml::node& entry : *list)
    read_coupling(reader, entry, wearer, seen);
}

/// A file from before says nothing of sensors that are left out.
void read_left_out(Reader& reader, const toml::table& root, WearerCalibration& wearer) {
  const toml::node* node = root.get("left_out");
  if (node == nullptr) return;
  const toml::array* list = node->as_array();
  if (list == nullptr)
    return reader.complain(*node, "left_out must be a list of sensors, as [\"index_pip\"]");
  for (const toml::node& entry : *list) {
    const auto name = entry.value_exact<std::string>();
    if (!name) return reader.complain(entry, "left_out: each sensor must be a name in quotes");
    const auto sensor = reader.sensor(entry, *name);
    if (!sensor) return;
    if (wearer.calibration[*sensor].gain_rad_per_count != 0.0)
      return reader.complain(entry,
                             *name + " is in left_out and in [sensors]; keep it in one of them");
    wearer.left_out.add(*sensor);
  }
}

void read_glove(Reader& reader, const toml::table& root, WearerCalibration& wearer) {
  const toml::table* glove = reader.table(root, "glove");
  if (glove == nullptr) return;
  reader.allow_only(*glove, {"model", "serial", "counts_most", "whole_range"});
  wearer.glove_model = reader.text(*glove, "model");
  reader.check(*glove, "glove model", complaint_about_text(wearer.glove_model, true));
  wearer.glove_serial = reader.text(*glove, "serial");
  reader.check(*glove, "glove serial", complaint_about_text(wearer.glove_serial, true));
  wearer.counts.most = reader.count(*glove, "counts_most");
  wearer.counts.whole_range = reader.truth(*glove, "whole_range");
}

/// A file without a shape is of an average hand.
void read_shape(Reader& reader, const toml::table& root, WearerShape& shape) {
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

void read_hand(Reader& reader, const toml::table& root, WearerCalibration& wearer) {
  const std::string hand = reader.text(root, "hand");
  if (hand != "left" && hand != "right")
    reader.check(root["hand"].node() != nullptr ? *root["hand"].node() : root,
                 "hand " + in_quotes(hand), "must be \"left\" or \"right\"");
  wearer.side = hand == "left" ? Side::left : Side::right;
  const toml::table* size = reader.table(root, "hand_size");
  if (size == nullptr) return;
  reader.allow_only(*size, {"length_m", "breadth_m"});
  wearer.size.length_m = reader.number(*size, "length_m");
  wearer.size.breadth_m = reader.number(*size, "breadth_m");
  read_shape(reader, root, wearer.size.shape);
  reader.check(*size, "hand_size", complaint_about(wearer.size));
}

void read_wearer(Reader& reader, const toml::table& root, WearerCalibration& wearer) {
  reader.allow_only(root, {"version", "user", "hand", "made", "method", "middle_bias", "mixed_in",
                           "left_out", "glove", "hand_size", "hand_shape", "sensors"});
  wearer.user = reader.text(root, "user");
  reader.check(root, "user", complaint_about_text(wearer.user, false));
  wearer.method = reader.text(root, "method");
  reader.check(root, "method", complaint_about_text(wearer.method, false));
  wearer.made = reader.time(root, "made");
  wearer.calibration.middle_bias = reader.number(root, "middle_bias");
  reader.check(root, "middle_bias", complaint_about_bias(wearer.calibration.middle_bias));
  read_mixed_in(reader, root, wearer);
  read_glove(reader, root, wearer);
  read_hand(reader, root, wearer);
  read_sensors(reader, root, wearer);
  read_left_out(reader, root, wearer);
}

std::string one_line(std::string_view text) {
  return printable(text.substr(0, 160));
}

} // namespace

Result<WearerCalibration> parse_calibration(std::string_view text, std::string_view name) {
  if (const auto fault = find_toml_fault(text)) return bad_line(name, fault->line, fault->what);
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return bad_line(name, error.source().begin.line,
                    one_line(error.description()) + "; mend it or calibrate again");
  }
  Reader reader(name);
  const toml::node* version = reader.find(root, "version");
  if (version != nullptr && version->value_exact<std::int64_t>() != 1)
    reader.complain(*version, "is of a version that this program does not know; it reads 1");
  WearerCalibration wearer;
  if (!reader.error()) read_wearer(reader, root, wearer);
  if (reader.error()) return *reader.error();
  return wearer;
}

} // namespace nendo::hand
