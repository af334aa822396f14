#include <nendo/hand/calibration_exchange.hpp>

#include <array>
#include <optional>
#include <string>

#include <nendo/base/files.hpp>
#include <nendo/base/table.hpp>
#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>

#include "calibration_check.hpp"

namespace nendo::hand {
namespace {

constexpr std::size_t max_head_bytes = 1000;
constexpr std::string_view header = "sensor,gain_rad_per_count,offset_counts";

constexpr std::string_view gain_rad = "gain_rad_per_count";
constexpr std::string_view gain_deg = "gain_deg_per_count";

/// TOML's lines may begin with [, but no line of ours has a joint's name of a ROS driver.
bool looks_like_yaml(std::string_view line) noexcept {
  const auto has = [&](std::string_view what) { return line.find(what) != std::string_view::npos; };
  return line.starts_with('{') || line.starts_with('%') || line.starts_with("---") ||
         line.starts_with("- ") || line == "[" || has("G_");
}

class CsvCalibration {
public:
  CsvCalibration(std::string_view text, std::string_view name)
      : table_(text, std::string(name)), name_(name) {}

  Result<ImportedCalibration> parse() {
    if (auto fine = find_columns(); !fine) return fine.error();
    std::size_t sensors = 0;
    for (;; ++sensors) {
      const auto any = table_.next();
      if (!any) return any.error();
      if (!*any) break;
      if (auto fine = read_row(); !fine) return fine.error();
    }
    if (sensors == 0) return table_.bad("has a header but no sensors; add a row for each sensor");
    auto result = imported(lines_, name_, false);
    if (const std::string others = table_.columns_not_read(); result && !others.empty())
      result->notes.push_back("not read: " + others);
    return result;
  }

private:
  Result<void> find_columns() {
    if (auto fine = table_.read_head(header); !fine) return fine;
    const auto sensor = table_.find("sensor");
    auto gain = table_.find(gain_rad);
    if (const auto degrees = table_.find(gain_deg)) {
      if (gain) return table_.bad("there are gains in radians and in degrees; leave one out");
      gain = degrees;
      unit_rad_ = from_degrees(1.0);
    }
    const auto offset = table_.find("offset_counts");
    if (!sensor || !gain || !offset)
      return table_.bad("the header must have the columns " + std::string(header));
    for (const std::string_view name :
         {std::string_view("sensor"), gain_rad, gain_deg, std::string_view("offset_counts")})
      if (table_.is_double(name))
        return table_.bad("there are two columns " + std::string(name) + "; leave one out");
    sensor_ = *sensor;
    gain_ = *gain;
    offset_ = *offset;
    return {};
  }

  Result<void> read_row() {
    const auto found = sensor_named(TableReader::plain(table_.cell(sensor_)));
    if (!found) return table_.bad_cell(sensor_, "is no sensor; use names like index_mcp");
    const std::string name(name_of(*found));
    const auto gain = table_.number(gain_);
    const auto offset = table_.number(offset_);
    if (!gain || !offset)
      return table_.bad_cell(gain ? offset_ : gain_, "of " + name + " is no finite number; fix it");
    const auto slot = static_cast<std::size_t>(*found);
    if (lines_.line[slot] != 0) return table_.bad("'" + name + "' is here twice; leave one out");
    if (*gain == 0.0) return table_.bad("'" + name + "' has a gain of 0; leave it out");
    lines_.sensors[slot] = {*gain * unit_rad_, *offset};
    lines_.line[slot] = table_.line();
    return {};
  }

  TableReader table_;
  std::string_view name_;
  ReadLines lines_;
  std::size_t sensor_ = 0, gain_ = 0, offset_ = 0; ///< columns
  double unit_rad_ = 1.0;                          ///< the gains' unit
};

// The places of the hand model of asr_cyberglove_lib. It turns fingers about one axis, so that the
// index finger spreads towards negative angles and ring and little finger towards positive ones;
// flexion is negative. The middle finger's abduction, which its programs ignore, is the palm arch.
constexpr std::array places{
    Sensor::wrist_yaw,       Sensor::wrist_pitch,
    Sensor::thumb_abduction, Sensor::thumb_roll,
    Sensor::thumb_mcp,       Sensor::thumb_ip,
    Sensor::index_mcp,       Sensor::index_middle_abduction,
    Sensor::index_pip,       Sensor::index_dip,
    Sensor::middle_mcp,      Sensor::palm_arch,
    Sensor::middle_pip,      Sensor::middle_dip,
    Sensor::ring_mcp,        Sensor::middle_ring_abduction,
    Sensor::ring_pip,        Sensor::ring_dip,
    Sensor::little_mcp,      Sensor::ring_little_abduction,
    Sensor::little_pip,      Sensor::little_dip,
};
/// The sensors whose angles have our sign there; the others' are negative.
constexpr SensorMask same_sign =
    mask_of(std::array{Sensor::middle_ring_abduction, Sensor::ring_little_abduction});

struct Point {
  double angle_rad;
  double count;
};

std::optional<Point> point_of(std::string_view field) {
  const std::string_view angle = cut(field, ':');
  const auto angle_rad = to_finite_number(angle);
  const auto count = to_finite_number(field);
  if (!angle_rad || !count || *count < 0.0 || *count > 255.0) return std::nullopt;
  return Point{*angle_rad, *count};
}

} // namespace

CalibrationFormat format_of(std::string_view text) noexcept {
  LineReader lines(text);
  const bool is_named = text.find("cyberglove_calibration") != std::string_view::npos;
  while (const auto line = lines.next()) {
    const std::string plain = TableReader::plain(line->substr(0, max_head_bytes));
    const bool has_gain =
        plain.find(gain_rad) != std::string::npos || plain.find(gain_deg) != std::string::npos;
    if (has_gain && plain.find('=') == std::string::npos) return CalibrationFormat::csv;
    if (line->starts_with('#') || plain.starts_with("sep=")) continue;
    if (line->starts_with('<')) return CalibrationFormat::ros_xml;
    if (is_named || looks_like_yaml(*line)) return CalibrationFormat::ros_yaml;
    if (line->starts_with("version") || line->starts_with('[')) return CalibrationFormat::toml;
    const std::string_view first = line->substr(0, line->find_first_of(" \t"));
    const std::size_t colon = first.find(':');
    const bool pair = colon != std::string_view::npos && to_finite_number(first.substr(0, colon)) &&
                      to_finite_number(first.substr(colon + 1));
    if (pair) return CalibrationFormat::two_point;
    if (line->find(" = ") != std::string_view::npos) return CalibrationFormat::toml;
    return CalibrationFormat::virtualhand;
  }
  return CalibrationFormat::virtualhand;
}

Result<ImportedCalibration> parse_calibration_csv(std::string_view text, std::string_view name) {
  return CsvCalibration(text, name).parse();
}

Result<ExportedCalibration> calibration_csv_text(const Calibration& calibration) {
  ExportedCalibration result{std::string(header) + "\n", {}};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& line = calibration.sensors[slot];
    if (line.gain_rad_per_count == 0.0) continue;
    result.text += std::string(sensor_names[slot]) + "," + decimal_text(line.gain_rad_per_count) +
                   "," + decimal_text(line.offset_counts) + "\n";
  }
  if (calibration.has_couplings())
    result.notes.emplace_back("the couplings (mixed_in) are lost: a CSV file has none");
  if (calibration.middle_bias != 0.0)
    result.notes.emplace_back("the middle bias is lost: a CSV file has none");
  return result;
}

Result<ImportedCalibration> parse_two_point(std::string_view text, std::string_view name) {
  LineReader lines(text);
  const auto bad = [&](const std::string& what) { return bad_line(name, lines.line(), what); };
  ReadLines read;
  std::size_t at = 0;
  for (; const auto line = lines.next(); ++at) {
    if (at == places.size()) return bad("has more than 22 lines; this is another format");
    const auto fields = fields_of(*line);
    const auto a = point_of(fields[0]);
    const auto b = point_of(fields.size() == 2 ? fields[1] : std::string_view{});
    const Sensor sensor = places[at];
    const std::string place = std::string(name_of(sensor)) + ": ";
    if (!a || !b) return bad(place + "must be two points angle_rad:count, counts 0 to 255");
    if (sensor == Sensor::palm_arch) continue;
    if (a->count == b->count) return bad(place + "has one count for two angles; measure it again");
    const double slope = (b->angle_rad - a->angle_rad) / (b->count - a->count);
    if (slope == 0.0) return bad(place + "has one angle at two counts; measure it again");
    const auto slot = index_of(sensor);
    read.sensors[slot] = {same_sign.has(sensor) ? slope : -slope, a->count - a->angle_rad / slope};
    read.line[slot] = lines.line();
  }
  if (at < places.size())
    return bad("ends after " + std::to_string(at) + " of 22 lines; it is no whole file");
  auto result = imported(read, name, false);
  if (result) result->notes.emplace_back("the palm arch is not in this format");
  return result;
}

Result<std::string> read_calibration_text(const std::filesystem::path& path) {
  return read_file(path, max_calibration_bytes, "calibration");
}

} // namespace nendo::hand
