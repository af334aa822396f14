#include "gloves/monitor_screen.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <nendo/base/text.hpp>
#include <nendo/hand/joint_angles.hpp>

#include "gloves/screen_text.hpp"

namespace nendo::gloves {
namespace {

constexpr int name_width = 22; // index_middle_abduction
constexpr int count_width = 6;
constexpr int angle_width = 9; // " -123 deg"
constexpr int min_bar = 8;
constexpr int column_gap = 2;

std::string on_or_off(bool on) {
  return on ? "on" : "off";
}

std::string glove_line(const MonitorPicture& picture, int width) {
  const driver::GloveInfo& info = *picture.info;
  const Side side = picture.sample != nullptr ? picture.sample->side : info.side;
  const auto position =
      picture.sample != nullptr ? picture.sample->wrist_switch : WristSwitch::unknown;
  std::string right = std::string(name_of(side)) + " hand";
  if (!picture.wearer.empty()) right += " of " + cut(printable(picture.wearer), name_width);
  if (picture.uncalibrated) right += ", uncalibrated";
  if (position != WristSwitch::unknown)
    right += ", switch " + on_or_off(position == WristSwitch::on);
  if (info.abilities.light) right += ", light " + on_or_off(picture.light);
  return both_ends(printable(info.source + ": " + info.model), right, width);
}

/// Returns "index_pip stands still at 255 while the hand moves: ...".
std::string stuck_text(const MonitorPicture& picture) {
  std::string text;
  for (const Sensor sensor : picture.left_out) {
    text.append(text.empty() ? "" : ", ").append(name_of(sensor));
    text += " stands still at " + std::to_string((*picture.sample)[sensor].value);
  }
  return text + ": estimated (e)";
}

std::string angle_text(const MonitorPicture& picture, Sensor sensor) {
  const hand::Calibration& calibration = *picture.calibration;
  if (calibration[sensor].gain_rad_per_count == 0.0) return std::string(angle_width, ' ');
  const auto angles_rad = hand::filled_angles_rad(*picture.sample, calibration, picture.left_out);
  const double angle_rad = angles_rad[index_of(sensor)];
  const double angle_deg = std::round(to_degrees(angle_rad)) + 0.0; // 0 without a sign
  const char* const mark = picture.left_out.has(sensor) ? "e" : (picture.uncalibrated ? "~" : "");
  return right_aligned(mark + fixed(std::clamp(angle_deg, -999.0, 999.0), 0) + " deg", angle_width);
}

std::string sensor_text(const MonitorPicture& picture, Sensor sensor, int width) {
  const RawCount count = (*picture.sample)[sensor];
  std::string text(name_of(sensor));
  text.resize(name_width, ' ');
  text += right_aligned(std::to_string(count.value), count_width);
  int space = width - name_width - count_width - 1;
  const bool with_angle = picture.calibration != nullptr && space - angle_width >= min_bar;
  if (with_angle) space -= angle_width;
  if (space >= min_bar) {
    text += " " +
            count_bar(space, count.value, (*picture.seen)[sensor], picture.info->counts.max_count);
  }
  if (with_angle) text += angle_text(picture, sensor);
  return cut(text, width);
}

void add_sensors(const MonitorPicture& picture, cli::ScreenSize size, int rows,
                 std::vector<std::string>& lines) {
  std::vector<Sensor> sensors;
  for (const Sensor sensor : picture.sample->present)
    sensors.push_back(sensor);
  const int count = static_cast<int>(sensors.size());
  const int half_width = (size.columns - column_gap) / 2;
  const bool in_two = count > rows && half_width >= name_width + count_width;
  const int wanted_rows = in_two ? (count + 1) / 2 : count;
  const bool all_fit = wanted_rows <= rows;
  const int shown_rows = all_fit ? wanted_rows : rows - 1;
  const std::size_t column_width =
      static_cast<std::size_t>(half_width) + static_cast<std::size_t>(column_gap);
  for (int row = 0; row < shown_rows; ++row) {
    std::string line = sensor_text(picture, sensors[static_cast<std::size_t>(row)],
                                   in_two ? half_width : size.columns);
    const int beside = row + shown_rows;
    if (in_two && beside < count) {
      line.resize(column_width, ' ');
      line += sensor_text(picture, sensors[static_cast<std::size_t>(beside)], half_width);
    }
    lines.push_back(std::move(line));
  }
  if (all_fit || rows <= 0) return;
  const int hidden = count - shown_rows * (in_two ? 2 : 1);
  lines.push_back(
      cut("and " + std::to_string(hidden) + " more: make the window larger", size.columns));
}

} // namespace

void SeenCounts::add(const GloveSample& sample) noexcept {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const std::uint16_t count = sample.raw[slot].value;
    Range& range = ranges_[slot];
    if (!present_.has(static_cast<Sensor>(slot))) range = {count, count};
    range = {std::min(range.least, count), std::max(range.most, count)};
  }
  present_ = sample.present;
}

std::string count_bar(int width, std::uint16_t count, SeenCounts::Range seen, std::uint16_t most) {
  const auto place = [&](std::uint16_t value) {
    return std::min<int>(width - 1, int{value} * (width - 1) / std::max<int>(most, 1));
  };
  std::string bar(static_cast<std::size_t>(width), '.');
  const auto fill = [&](int from, int to, char with) {
    for (int at = from; at <= to; ++at)
      bar[static_cast<std::size_t>(at)] = with;
  };
  fill(place(seen.least), place(seen.most), '-');
  if (count > 0) fill(0, place(count), '#');
  fill(place(seen.least), place(seen.least), '[');
  fill(place(seen.most), place(seen.most), place(seen.most) == place(seen.least) ? '|' : ']');
  return bar;
}

std::vector<std::string> monitor_lines(const MonitorPicture& picture, cli::ScreenSize size) {
  std::string keys;
  if (picture.keys)
    keys = picture.info->abilities.light ? "q quit, r ranges, l light" : "q quit, r ranges";
  StreamState stream{picture.stats, picture.info->rate_hz};
  if (picture.sample != nullptr) stream.age_s = picture.age_s;
  std::vector<std::string> lines{glove_line(picture, size.columns),
                                 stream_line(stream, keys, size.columns)};
  if (picture.sample != nullptr && picture.left_out.bits != 0)
    lines.push_back(cut(stuck_text(picture), size.columns));
  if (picture.sample != nullptr)
    add_sensors(picture, size, size.rows - static_cast<int>(lines.size()), lines);
  lines.resize(std::min(lines.size(), static_cast<std::size_t>(std::max(size.rows, 0))));
  return lines;
}

} // namespace nendo::gloves
