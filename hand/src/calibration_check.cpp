#include "calibration_check.hpp"

#include <cmath>
#include <string>

#include <nendo/base/text.hpp>

namespace nendo::hand {
namespace {

// NaN lies nowhere.
bool lies_within(double value, double least, double most) noexcept {
  return value >= least && value <= most;
}

constexpr double max_offset_counts = 65535.0 * 100.0;
constexpr std::size_t max_text_bytes = 200;

std::string complaint_about_strings(const WearerCalibration& wearer) {
  struct Named {
    const char* name;
    const std::string* text;
    bool may_be_empty;
  };
  for (const auto& [name, text, may_be_empty] :
       {Named{"user", &wearer.user, false}, Named{"glove model", &wearer.glove_model, true},
        Named{"glove serial", &wearer.glove_serial, true},
        Named{"method", &wearer.method, false}}) {
    const std::string complaint = complaint_about_text(*text, may_be_empty);
    if (!complaint.empty()) return std::string(name) + " " + in_quotes(*text) + ": " + complaint;
  }
  return {};
}

std::string complaint_about_sensors(const WearerCalibration& wearer) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    const auto& line = wearer.calibration.sensors[slot];
    const bool calibrated = line.gain_rad_per_count != 0.0; // so is NaN
    std::string complaint;
    if (calibrated) complaint = complaint_about(sensor, line, wearer.counts);
    const auto& quality = wearer.quality[slot];
    if (complaint.empty() && quality)
      complaint = calibrated ? complaint_about(*quality)
                             : "has a quality but no gain; leave its quality out";
    if (!complaint.empty()) return std::string(name_of(sensor)) + ": " + complaint;
  }
  return {};
}

enum class Group : std::uint8_t { bend, pair, other };

/// Counts of these, and mostly of gaps, rise with the joint's angle. For the sensors of the wrist,
/// of the arch and the other ones of the thumb, the sign depends on how a glove is sewn.
bool measures_bending(Sensor sensor) noexcept {
  const std::string_view name = name_of(sensor);
  return name.ends_with("_mcp") || name.ends_with("_pip") || name.ends_with("_dip") ||
         name.ends_with("_ip");
}

Group group_of(Sensor sensor) noexcept {
  if (is_gap(sensor)) return Group::pair;
  return measures_bending(sensor) ? Group::bend : Group::other;
}

/// Returns whether some gains of the group are negative, and none is positive.
bool are_negative(const ReadLines& lines, Group group) noexcept {
  bool any = false;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const double gain = lines.sensors[slot].gain_rad_per_count;
    if (group_of(static_cast<Sensor>(slot)) != group) continue;
    if (gain > 0.0) return false;
    any = any || gain < 0.0;
  }
  return any;
}

void turn(ReadLines& lines, Group group) noexcept {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    auto& gain = lines.sensors[slot].gain_rad_per_count;
    if (group_of(static_cast<Sensor>(slot)) == group) gain = -gain;
  }
}

// The others' signs are free, so they are turned only where all of the text is in the other frame.
void turn_other_frames(ReadLines& lines, std::vector<std::string>& notes) {
  const bool bend = are_negative(lines, Group::bend);
  const bool pair = !lines.gaps_may_fall && are_negative(lines, Group::pair);
  if (bend) turn(lines, Group::bend);
  if (pair) turn(lines, Group::pair);
  if (bend && are_negative(lines, Group::other)) turn(lines, Group::other);
  if (bend) notes.emplace_back("its flexion is negative; turned, since ours is positive");
  if (pair) notes.emplace_back("its spreading is negative; turned, since ours is positive");
}

} // namespace

std::string complaint_about_text(std::string_view text, bool may_be_empty) {
  if (text.empty()) return may_be_empty ? "" : "must not be empty; give a name";
  if (text.size() > max_text_bytes) return "is longer than 200 bytes; shorten it";
  if (!is_utf8(text)) return "is not UTF-8; save it as UTF-8";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) return "has control characters; leave them out";
  }
  return {};
}

std::string complaint_about(Sensor sensor, const SensorCalibration& line, CountScale counts) {
  // Slot 23 has a place in the protocol.
  if (sensor == Sensor::unused) return "no glove has this sensor; leave it out";
  const double gain = line.gain_rad_per_count;
  if (gain == 0.0) return "a gain of 0 measures nothing; calibrate it or leave the sensor out";
  const double most = 255.0 / counts.max_count; // 1 rad a count of 8 bits
  if (!lies_within(std::abs(gain), 0.0, most))
    return "a gain of " + decimal_text(gain) + " is absurd; it must lie within " +
           decimal_text(most) + " rad a count";
  if (gain < 0.0 && measures_bending(sensor))
    return "a gain of " + decimal_text(gain) +
           " has the wrong sign; counts rise when the joint bends";
  if (lies_within(line.offset_counts, -max_offset_counts, max_offset_counts)) return {};
  return "the offset is absurd; give counts";
}

std::string complaint_about(const SensorQuality& quality) {
  if (!lies_within(quality.residual_rad, 0.0, 10.0)) return "residual_rad must lie within 0 and 10";
  if (!lies_within(quality.min_counts, 0.0, 65535.0) ||
      !lies_within(quality.max_counts, quality.min_counts, 65535.0))
    return "least_counts and most_counts must be counts, the least first";
  if (!lies_within(quality.confidence, 0.0, 1.0)) return "confidence must lie within 0 and 1";
  return {};
}

std::string complaint_about(const HandSize& size) {
  if (!lies_within(size.length_m, 0.05, 0.35)) return "length_m must lie within 0.05 and 0.35";
  if (!lies_within(size.breadth_m, 0.02, 0.2)) return "breadth_m must lie within 0.02 and 0.2";
  for (std::size_t k = 0; k < shape_terms; ++k) {
    const double most = max_of(static_cast<ShapeTerm>(k));
    if (!lies_within(size.shape.terms[k], -most, most))
      return std::string(shape_term_names[k]) + " must be a number from " + std::to_string(-most) +
             " to " + std::to_string(most);
  }
  return {};
}

std::string complaint_about_coupling(double rad_per_rad) {
  return lies_within(rad_per_rad, -10.0, 10.0) ? "" : "rad_per_rad must lie within -10 and 10";
}

std::string complaint_about_bias(double middle_bias) {
  return lies_within(middle_bias, -10.0, 10.0) ? "" : "middle_bias must lie within -10 and 10";
}

std::string complaint_about(const WearerCalibration& wearer) {
  using std::chrono::sys_days;
  using namespace std::chrono_literals;
  if (wearer.counts.max_count == 0) return "counts_most must lie within 1 and 65535";
  if (wearer.made < sys_days{1970y / 1 / 1} || wearer.made >= sys_days{10000y / 1 / 1})
    return "made must lie within the years 1970 and 9999";
  std::string complaint = complaint_about_strings(wearer);
  if (complaint.empty()) complaint = complaint_about(wearer.size);
  if (complaint.empty()) complaint = complaint_about_sensors(wearer);
  if (complaint.empty()) complaint = complaint_about_bias(wearer.calibration.middle_bias);
  for (const double gain : wearer.calibration.coupling_gains) {
    if (complaint.empty()) complaint = complaint_about_coupling(gain);
  }
  return complaint;
}

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
