#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_exchange.hpp>

#include "calibration_check.hpp"

namespace nendo::hand {
namespace {

constexpr std::size_t rows_per_group = 4;
constexpr auto gain_slot = index_of(Sensor::index_abduction);
constexpr auto bias_slot = index_of(Sensor::index_middle_abduction);
// What published calibrations have for pairs lies between 0.005 and 0.02 rad a count; a middle bias
// is 0 or some tenths.
constexpr double min_pair_gain = 0.002;
constexpr double max_pair_gain = 0.05;

std::string sensor_of(std::size_t slot) {
  return std::string(sensor_names[slot]);
}

class CalParser {
public:
  CalParser(std::string_view text, std::string_view name) : lines_(text), name_(name) {}
  Result<ImportedCalibration> parse() {
    while (const auto line = lines_.next()) {
      if (const auto done = read_line(*line); !done) return done.error();
    }
    if (row_ < sensor_slots)
      return bad("ends after " + std::to_string(row_) +
                 " of 24 rows `joint offset gain`; it is no whole .cal file");
    std::vector<std::string> notes;
    const auto middle_bias = resolve_middle_bias(notes);
    if (!middle_bias) return middle_bias.error();
    auto result = imported(rows_, name_, true);
    if (!result) return result;
    result->calibration.middle_bias = *middle_bias;
    result->side = side_;
    result->notes.insert(result->notes.begin(), notes.begin(), notes.end());
    return result;
  }

private:
  Result<void> read_line(std::string_view line) {
    if (line.starts_with('!')) return {};
    const auto fields = fields_of(line);
    read_side(fields);
    if (row_ == sensor_slots) return {}; // the hand's geometry
    return to_finite_number(fields.front()) ? read_row(fields) : read_heading(line);
  }
  Result<void> read_heading(std::string_view line) {
    if (line.starts_with("VHv")) {
      is_vti_ = true;
      const char major = line.size() > 3 ? line[3] : '?';
      if (major < '1' || major > '2')
        return bad("version " + in_quotes(line) +
                   " is not known; save the calibration as version 1 or 2");
      return {};
    }
    if (row_ % rows_per_group != 0)
      return bad(in_quotes(line) + " is where row " + std::to_string(row_ % rows_per_group + 1) +
                 " of 4 of a finger should; export the calibration once more");
    const auto fields = fields_of(line);
    if (fields.size() < 2 || fields[0] != "FINGER") return {};
    std::string_view number = fields[1];
    if (number.ends_with(':')) number.remove_suffix(1);
    const auto group = row_ / rows_per_group;
    if (to_finite_number(number) != static_cast<double>(group))
      return bad(in_quotes(line) + " is out of order; FINGER " + std::to_string(group) +
                 " should come here");
    return {};
  }
  Result<void> read_row(const std::vector<std::string_view>& fields) {
    const std::string place = sensor_of(row_) + ": ";
    if (fields.size() < 3)
      return bad(place + "a row needs joint, offset and gain; it is cut short");
    std::array<double, 3> numbers{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto number = to_finite_number(fields[k]);
      if (!number) return bad(place + in_quotes(fields[k]) + " is not a number; fix the row");
      numbers[k] = *number;
    }
    const auto [joint, offset, gain] = numbers;
    if (joint != static_cast<double>(row_ % rows_per_group) && joint != static_cast<double>(row_))
      return bad(place + "joint " + in_quotes(fields[0]) + " is out of order; joint " +
                 std::to_string(row_ % rows_per_group) + " should come here");
    if (offset < 0.0 || offset > 255.0)
      return bad(place + "offset " + in_quotes(fields[1]) +
                 " is no count of 0 to 255; fix the row");
    rows_.sensors[row_] = {gain, offset};
    rows_.line[row_] = lines_.line();
    ++row_;
    return {};
  }
  void read_side(const std::vector<std::string_view>& fields) {
    if (fields.size() < 2 || !fields[1].starts_with("HAND")) return;
    if (fields[0] == "LEFT") side_ = Side::left;
    if (fields[0] == "RIGHT") side_ = Side::right;
  }
  // VTI's library and those that follow it put the gain of slot 11 into slot 7, which no glove has,
  // and the middle bias where slot 11's gain should be. Another program's row of slot 7 may be
  // filled by habit: there what looks like a pair's gain is one.
  Result<double> resolve_middle_bias(std::vector<std::string>& notes) {
    SensorCalibration& unused = rows_.sensors[gain_slot];
    SensorCalibration& pair = rows_.sensors[bias_slot];
    const double as_gain = std::abs(pair.gain_rad_per_count);
    const bool looks_like_gain = as_gain >= min_pair_gain && as_gain <= max_pair_gain;
    const bool moved = unused.gain_rad_per_count != 0.0 && (is_vti_ || !looks_like_gain);
    double middle_bias = 0.0;
    if (moved) {
      middle_bias = pair.gain_rad_per_count;
      pair.gain_rad_per_count = unused.gain_rad_per_count;
      rows_.line[bias_slot] = rows_.line[gain_slot];
      notes.emplace_back(
          "the row of index_abduction holds the gain of index_middle_abduction, whose "
          "own is the middle bias, as in VirtualHand");
      const std::string complaint = complaint_about_bias(middle_bias);
      if (!complaint.empty()) return bad_line(name_, rows_.line[bias_slot], complaint);
    } else if (unused.gain_rad_per_count != 0.0) {
      notes.emplace_back("the row of index_abduction is left out: no glove has that sensor");
    }
    unused = {};
    rows_.sensors.back() = {}; // slot 23 is nothing's
    return middle_bias;
  }
  Error bad(const std::string& what) const { return bad_line(name_, lines_.line(), what); }

  LineReader lines_;
  std::string_view name_;
  ReadLines rows_;
  std::size_t row_ = 0;
  bool is_vti_ = false;
  std::optional<Side> side_;
};

/// Fails if a .cal file cannot say this gain.
Result<void> check_gain(std::size_t slot, double gain) {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, sensor_of(slot) + ": " + what};
  };
  if (gain == 0.0 && sensors_18.has(static_cast<Sensor>(slot)))
    return bad("not calibrated, which a .cal file cannot say; export as toml or csv");
  if (gain != 0.0 && std::abs(gain) < 0.5e-5)
    return bad("gain " + decimal_text(gain) +
               " is too small for the five decimals of a .cal file; export as toml or csv");
  return {};
}

/// Refuses offsets that are no counts: a joint may well have its angle of 0 beyond what its sensor
/// shows, as a thumb that never lies beside the index finger has, but the readers of .cal files,
/// VTI's and ours, take an offset for a count.
Result<void> check_offsets(const std::array<SensorCalibration, sensor_slots>& lines) {
  std::string outside;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const double offset = std::round(lines[slot].offset_counts);
    if (offset >= 0.0 && offset <= 255.0) continue;
    std::array<char, 40> counts{};
    std::snprintf(counts.data(), counts.size(), "%.1f", lines[slot].offset_counts);
    outside.append(outside.empty() ? "" : ", ").append(sensor_of(slot)).append(" (");
    outside.append(counts.data()).append(")");
  }
  if (outside.empty()) return {};
  return Error{Errc::bad_input,
               "these sensors' angles are 0 at counts that no sensor shows: " + outside +
                   "; a .cal file keeps that count, 0 to 255; export as toml or "
                   "csv"};
}

std::vector<std::string> losses(const Calibration& calibration, double scale) {
  std::vector<std::string> notes;
  if (calibration.has_couplings())
    notes.emplace_back("the couplings (mixed_in) are lost: a .cal file has none");
  for (const auto& line : calibration.sensors) {
    const double offset = line.offset_counts * scale;
    if (line.gain_rad_per_count == 0.0 || offset == std::round(offset)) continue;
    notes.emplace_back("offsets are rounded to whole counts");
    break;
  }
  return notes;
}

} // namespace

Result<ImportedCalibration> parse_virtualhand(std::string_view text, std::string_view name) {
  return CalParser(text, name).parse();
}

Result<ExportedCalibration> virtualhand_text(const Calibration& calibration, CountScale counts) {
  if (counts.self_calibrated || counts.max_count == 0)
    return Error{Errc::bad_input, "a .cal file is for a CyberGlove's bare counts, and this glove "
                                  "calibrates itself; export as toml or csv"};
  const double scale = 255.0 / counts.max_count;
  std::array<SensorCalibration, sensor_slots> lines{};
  for (std::size_t slot = 0; slot + 1 < sensor_slots; ++slot) { // slot 23 is nothing's
    const SensorCalibration& line = calibration.sensors[slot];
    if (slot != gain_slot)
      lines[slot] = {line.gain_rad_per_count / scale, line.offset_counts * scale};
  }
  if (auto fine = check_offsets(lines); !fine) return fine.error();
  std::string text = "VHv2.0\n! written by nendo\nGLOVE CALIBRATION follows:\n"
                     "! joint, offset, gain, gesture\n";
  std::array<char, 80> row{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    double gain = lines[slot].gain_rad_per_count;
    if (auto fine = check_gain(slot, gain); !fine) return fine.error();
    if (slot == gain_slot) gain = calibration.sensors[bias_slot].gain_rad_per_count / scale;
    if (slot == bias_slot) gain = calibration.middle_bias;
    if (slot % rows_per_group == 0)
      text += "FINGER " + std::to_string(slot / rows_per_group) + ":\n";
    if (!(std::abs(gain) <= 10.0))
      return Error{Errc::bad_input, sensor_of(slot) + ": its gain is absurd; calibrate again"};
    std::snprintf(row.data(), row.size(), "%3d%6ld%10.5f%5d\n",
                  static_cast<int>(slot % rows_per_group), std::lround(lines[slot].offset_counts),
                  gain, 0);
    text += row.data();
  }
  return ExportedCalibration{text + "! E_O_CAL\n", losses(calibration, scale)};
}

} // namespace nendo::hand
