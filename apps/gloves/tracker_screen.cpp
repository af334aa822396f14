#include "gloves/tracker_screen.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <nendo/base/text.hpp>

#include "gloves/screen_text.hpp"
#include "gloves/tracker_text.hpp"

namespace nendo::gloves {
namespace {

constexpr int station_width = 7;
struct Column {
  std::string_view name;
  int width;
};
constexpr std::array columns{Column{"x mm", 9},    Column{"y mm", 9},       Column{"z mm", 9},
                             Column{"azimuth", 8}, Column{"elevation", 10}, Column{"roll", 7},
                             Column{"per s", 7},   Column{"age ms", 7},     Column{"error", 6}};

std::string row(const std::string& station, const std::array<std::string, columns.size()>& cells,
                int width) {
  std::string line = station;
  line.resize(std::max<std::size_t>(line.size(), station_width), ' ');
  for (std::size_t at = 0; at < cells.size(); ++at)
    line += right_aligned(cells[at], columns[at].width);
  return cut(std::move(line), width);
}

std::string heading(int width) {
  std::array<std::string, columns.size()> names;
  for (std::size_t at = 0; at < columns.size(); ++at)
    names[at] = columns[at].name;
  return row("station", names, width);
}

std::string station_row(const StationPicture& picture, HostTime now, int width) {
  const std::string number = right_aligned(std::to_string(picture.station), station_width);
  const auto& pose = picture.seen->latest();
  if (!pose) return cut(number + "  no pose yet", width);
  const TurnAngles turn = angles_of(pose->turn_xyzw);
  const double age_ms = to_milliseconds(now - pose->arrival);
  return row(number,
             {fixed(1000.0 * pose->position_m[0], 1), fixed(1000.0 * pose->position_m[1], 1),
              fixed(1000.0 * pose->position_m[2], 1), fixed(turn.azimuth_deg, 1),
              fixed(turn.elevation_deg, 1), fixed(turn.roll_deg, 1),
              fixed(picture.seen->rate_hz(), 1), fixed(std::max(age_ms, 0.0), 0),
              pose->error == ' ' ? "-" : printable(std::string(1, pose->error))},
             width);
}

std::optional<double> age_of_newest(const TrackerPicture& tracker, HostTime now) {
  std::optional<double> age_s;
  for (const StationPicture& station : tracker.stations) {
    const auto& pose = station.seen->latest();
    if (!pose) continue;
    const double of_station_s = to_seconds(now - pose->arrival);
    age_s = std::min(age_s.value_or(of_station_s), of_station_s);
  }
  return age_s;
}

} // namespace

void SeenPoses::add(const PoseSample& pose) {
  latest_ = pose;
  rate_.add(++count_, pose.arrival);
}

std::vector<std::string> tracker_lines(const std::vector<TrackerPicture>& trackers, HostTime now,
                                       bool has_keys, cli::ScreenSize size) {
  std::vector<std::string> lines;
  const char* keys = has_keys ? "q quit" : "";
  for (const TrackerPicture& tracker : trackers) {
    const driver::TrackerInfo& info = *tracker.info;
    lines.push_back(both_ends(printable(info.source + ": " + info.model),
                              info.is_filtered ? "filtered" : "", size.columns));
    lines.push_back(
        stream_line({tracker.stats, info.rate_hz, age_of_newest(tracker, now), "no pose yet"},
                    std::exchange(keys, ""), size.columns));
  }
  lines.push_back(heading(size.columns));
  for (const TrackerPicture& tracker : trackers)
    for (const StationPicture& station : tracker.stations)
      lines.push_back(station_row(station, now, size.columns));
  lines.resize(std::min(lines.size(), static_cast<std::size_t>(std::max(size.rows, 0))));
  return lines;
}

} // namespace nendo::gloves
