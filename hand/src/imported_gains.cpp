#include "imported_gains.hpp"

#include <string>
#include <utility>

#include <nendo/base/text.hpp>

#include "calibration_check.hpp"

namespace nendo::hand {
namespace {

enum class Group : std::uint8_t { bend, pair, other };

Group group_of(Sensor sensor) noexcept {
  if (!rises_with_angle(sensor)) return Group::other;
  return name_of(sensor).ends_with("abduction") ? Group::pair : Group::bend;
}

struct Signs {
  std::size_t positive = 0;
  std::size_t negative = 0;
  bool all_negative() const noexcept { return negative > 0 && positive == 0; }
};

Signs signs_of(const ReadLines& lines, Group group) noexcept {
  Signs signs;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (group_of(static_cast<Sensor>(slot)) != group) continue;
    const double gain = lines.sensors[slot].gain_rad_per_count;
    if (gain > 0.0) ++signs.positive;
    if (gain < 0.0) ++signs.negative;
  }
  return signs;
}

void turn(ReadLines& lines, Group group) noexcept {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    auto& gain = lines.sensors[slot].gain_rad_per_count;
    if (group_of(static_cast<Sensor>(slot)) == group) gain = -gain;
  }
}

// The others' signs are free, so they are turned only where all of the text is in the other frame.
void turn_other_frames(ReadLines& lines, std::vector<std::string>& notes) {
  const bool bend = signs_of(lines, Group::bend).all_negative();
  const bool pair = !lines.gaps_may_fall && signs_of(lines, Group::pair).all_negative();
  if (bend) turn(lines, Group::bend);
  if (pair) turn(lines, Group::pair);
  if (bend && signs_of(lines, Group::other).all_negative()) turn(lines, Group::other);
  if (bend) notes.emplace_back("its flexion is negative; turned, since ours is positive");
  if (pair) notes.emplace_back("its spreading is negative; turned, since ours is positive");
}

} // namespace

Result<ImportedCalibration> imported(ReadLines lines, std::string_view name, bool complete) {
  ImportedCalibration result;
  turn_other_frames(lines, result.notes);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    const SensorCalibration& line = lines.sensors[slot];
    const bool needed = complete && sensors_18.has(sensor);
    if (line.gain_rad_per_count == 0.0 && !needed) continue;
    std::string complaint = complaint_about(sensor, line, CountScale{});
    if (complaint.empty() && !lines.gaps_may_fall && line.gain_rad_per_count < 0.0 &&
        is_gap(sensor))
      complaint = "a gain of " + decimal_text(line.gain_rad_per_count) +
                  " has the wrong sign; the other gaps' rise when the fingers spread";
    if (!complaint.empty())
      return bad_line(name, lines.line[slot], std::string(name_of(sensor)) + ": " + complaint);
    result.calibration.sensors[slot] = line;
  }
  return result;
}

} // namespace nendo::hand
