#include <algorithm>
#include <array>
#include <string>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_exchange.hpp>

#include "calibration_check.hpp"
#include "imported_gains.hpp"

namespace nendo::hand {
namespace {

constexpr std::string_view header = "sensor,gain_rad_per_count,offset_counts";

std::string without_blanks(std::string_view line) {
  std::string text(line);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  return text;
}

} // namespace

CalibrationFormat format_of(std::string_view text) noexcept {
  LineReader lines(text);
  while (const auto line = lines.next()) {
    if (line->starts_with('#')) continue;
    if (line->starts_with("sensor,") || line->starts_with("sensor ,"))
      return CalibrationFormat::csv;
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
  LineReader lines(text);
  const auto bad = [&](const std::string& what) { return bad_line(name, lines.line(), what); };
  ReadLines read;
  bool has_header = false;
  std::size_t sensors = 0;
  while (const auto line = lines.next()) {
    if (line->starts_with('#')) continue;
    if (!has_header) {
      if (without_blanks(*line) != header)
        return bad("the header must be " + std::string(header) + ", not " + in_quotes(*line));
      has_header = true;
      continue;
    }
    if (std::count(line->begin(), line->end(), ',') != 2)
      return bad(in_quotes(*line) + " must have three columns, " + std::string(header));
    std::string_view rest = *line;
    const std::string_view sensor = trimmed(cut(rest, ','));
    const auto gain = to_finite_number(trimmed(cut(rest, ',')));
    const auto offset = to_finite_number(trimmed(rest));
    const auto found = sensor_named(sensor);
    if (!found) return bad("no sensor is called " + in_quotes(sensor));
    if (!gain || !offset) return bad(in_quotes(sensor) + " needs two finite numbers; mend the row");
    const auto slot = static_cast<std::size_t>(*found);
    if (read.line[slot] != 0) return bad(in_quotes(sensor) + " stands here twice; leave one out");
    if (*gain == 0.0) return bad(in_quotes(sensor) + " has a gain of 0; leave it out");
    read.sensors[slot] = {*gain, *offset};
    read.line[slot] = lines.line();
    ++sensors;
  }
  if (!has_header) return bad("is empty; the header must be " + std::string(header));
  if (sensors == 0) return bad("has a header but no sensors; add a row a sensor");
  return imported(read, name, false);
}

Result<ExportedCalibration> calibration_csv_text(const Calibration& calibration) {
  ExportedCalibration result{std::string(header) + "\n", {}};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& line = calibration.sensors[slot];
    if (line.gain_rad_per_count == 0.0) continue;
    result.text += std::string(sensor_names[slot]) + "," + decimal_text(line.gain_rad_per_count) +
                   "," + decimal_text(line.offset_counts) + "\n";
  }
  const bool couples = std::any_of(calibration.mixed_in.begin(), calibration.mixed_in.end(),
                                   [](double mixed_in) { return mixed_in != 0.0; });
  if (couples) result.notes.emplace_back("the couplings (mixed_in) are lost: a CSV file has none");
  if (calibration.middle_bias != 0.0)
    result.notes.emplace_back("the middle bias is lost: a CSV file has none");
  return result;
}

Result<std::string> read_calibration_text(const std::filesystem::path& path) {
  return read_file(path, most_calibration_bytes, "calibration");
}

Result<void> write_calibration_text(const std::filesystem::path& path, std::string_view text) {
  return replace_file(path, text);
}

} // namespace nendo::hand
