#include <array>
#include <string>

#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_exchange.hpp>

#include "imported_gains.hpp"

namespace nendo::hand {
namespace {

struct Place {
  Sensor sensor;
  double sign; ///< sign of our angle relative to the file's hand model
};

// The places of the hand model of asr_cyberglove_lib. It turns fingers about one axis, so that the
// index finger spreads towards negative angles and ring and little finger towards positive ones;
// flexion is negative.
constexpr std::array<Place, 22> places{{
    {Sensor::wrist_yaw, -1.0},
    {Sensor::wrist_pitch, -1.0},
    {Sensor::thumb_abduction, -1.0},
    {Sensor::thumb_roll, -1.0},
    {Sensor::thumb_mcp, -1.0},
    {Sensor::thumb_ip, -1.0},
    {Sensor::index_mcp, -1.0},
    {Sensor::index_middle_abduction, -1.0},
    {Sensor::index_pip, -1.0},
    {Sensor::index_dip, -1.0},
    {Sensor::middle_mcp, -1.0},
    {Sensor::palm_arch, 1.0}, // the middle finger's abduction, which its programs ignore
    {Sensor::middle_pip, -1.0},
    {Sensor::middle_dip, -1.0},
    {Sensor::ring_mcp, -1.0},
    {Sensor::middle_ring_abduction, 1.0},
    {Sensor::ring_pip, -1.0},
    {Sensor::ring_dip, -1.0},
    {Sensor::little_mcp, -1.0},
    {Sensor::ring_little_abduction, 1.0},
    {Sensor::little_pip, -1.0},
    {Sensor::little_dip, -1.0},
}};

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
    const auto [sensor, sign] = places[at];
    const std::string place = std::string(name_of(sensor)) + ": ";
    if (!a || !b) return bad(place + "must be two points angle_rad:count, counts 0 to 255");
    if (sensor == Sensor::palm_arch) continue;
    if (a->count == b->count) return bad(place + "has one count for two angles; measure it again");
    const double slope = (b->angle_rad - a->angle_rad) / (b->count - a->count);
    if (slope == 0.0) return bad(place + "has one angle at two counts; measure it again");
    const auto slot = index_of(sensor);
    read.sensors[slot] = {sign * slope, a->count - a->angle_rad / slope};
    read.line[slot] = lines.line();
  }
  if (at < places.size())
    return bad("ends after " + std::to_string(at) + " of 22 lines; it is no whole file");
  auto result = imported(read, name, false);
  if (result) result->notes.emplace_back("the palm arch is not in this format");
  return result;
}

} // namespace nendo::hand
