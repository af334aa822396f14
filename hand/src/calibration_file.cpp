#include <nendo/hand/calibration_file.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <system_error>
#include <utility>
#include <vector>

#include <unistd.h>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

#include "calibration_check.hpp"
#include "toml_text.hpp"

namespace nendo::hand {
namespace {

namespace fs = std::filesystem;
using std::chrono::sys_seconds;

constexpr std::string_view extension = ".toml";
constexpr unsigned max_version_number = 9999;

// -0.0 is written, so that what is read back has the same bits.
bool is_plain_zero(double value) noexcept {
  return std::bit_cast<std::uint64_t>(value) == 0;
}

} // namespace

std::string toml_string(std::string_view text) {
  std::string written = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') written += '\\';
    written += c;
  }
  return written + "\"";
}

namespace {

std::string sensor_line(Sensor sensor, const SensorCalibration& line,
                        const std::optional<SensorQuality>& quality) {
  std::string text = std::string(name_of(sensor)) +
                     " = { gain_rad_per_count = " + decimal_text(line.gain_rad_per_count) +
                     ", offset_counts = " + decimal_text(line.offset_counts);
  if (quality) {
    text += ", residual_rad = " + decimal_text(quality->residual_rad) +
            ", least_counts = " + decimal_text(quality->min_counts) +
            ", most_counts = " + decimal_text(quality->max_counts) +
            ", confidence = " + decimal_text(quality->confidence);
  }
  return text + " }\n";
}

std::string mixed_in_lines(const Calibration& calibration) {
  std::string text;
  for (std::size_t k = 0; k < couplings.size(); ++k) {
    if (is_plain_zero(calibration.coupling_gains[k])) continue;
    text += "  { of = \"" + std::string(name_of(couplings[k].of)) + "\", by = \"" +
            std::string(name_of(couplings[k].by)) +
            "\", rad_per_rad = " + decimal_text(calibration.coupling_gains[k]) + " },\n";
  }
  return text.empty() ? "" : "mixed_in = [\n" + text + "]\n";
}

std::string left_out_line(SensorMask left_out) {
  std::string names;
  for (const Sensor sensor : left_out)
    names.append(names.empty() ? "\"" : "\", \"").append(name_of(sensor));
  return names.empty() ? "" : "# stuck when it was made\nleft_out = [" + names + "\"]\n";
}

std::string shape_lines(const WearerShape& shape) {
  if (shape.is_average()) return "";
  std::string text = "\n[hand_shape]\n";
  for (std::size_t k = 0; k < shape_terms; ++k)
    text += std::string(shape_term_names[k]) + " = " + decimal_text(shape.terms[k]) + "\n";
  return text;
}

// NAME.20261121T192705Z.toml, or NAME.20261121T192705Z-2.toml: when it went out of use, and which
// one of that second.
struct Version {
  std::string date;
  unsigned number = 1;
  friend auto operator<=>(const Version&, const Version&) = default;
};

std::optional<Version> version_of(std::string_view file_name, std::string_view stem) {
  constexpr std::string_view form = "00000000T000000Z";
  if (!file_name.starts_with(stem) || !file_name.ends_with(extension)) return std::nullopt;
  file_name.remove_prefix(stem.size());
  if (file_name.size() < 1 + form.size() + extension.size() || file_name.front() != '.')
    return std::nullopt;
  file_name.remove_prefix(1);
  file_name.remove_suffix(extension.size());
  Version version{std::string(file_name.substr(0, form.size()))};
  for (std::size_t k = 0; k < form.size(); ++k) {
    const char c = version.date[k];
    if (form[k] == '0' ? (c < '0' || c > '9') : c != form[k]) return std::nullopt;
  }
  file_name.remove_prefix(form.size());
  if (file_name.empty()) return version;
  const auto number = to_finite_number(file_name.substr(1));
  if (file_name.front() != '-' || !number || *number < 2.0 || *number > max_version_number)
    return std::nullopt;
  version.number = static_cast<unsigned>(*number);
  return version;
}

std::string version_name(const std::string& stem, const Version& version) {
  return stem + "." + version.date +
         (version.number > 1 ? "-" + std::to_string(version.number) : "") + std::string(extension);
}

std::string compact(sys_seconds time) {
  std::string text = rfc3339(time);
  std::erase_if(text, [](char c) { return c == '-' || c == ':'; });
  return text;
}

using Versions = std::vector<std::pair<Version, fs::path>>;

Versions versions_of(const fs::path& target) {
  const std::string stem = target.stem().string();
  Versions versions;
  std::error_code failed;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    if (auto version = version_of(at->path().filename().string(), stem))
      versions.emplace_back(*std::move(version), at->path());
  }
  std::sort(versions.begin(), versions.end());
  return versions;
}

/// Gives the file of today a second name, after those of all its versions, even if the clock was
/// put back or old ones of this second are gone. Empty if there is no file.
Result<fs::path> keep_as_earlier(const fs::path& path) {
  const fs::path target = target_of(path);
  Version version{
      compact(std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()))};
  const Versions versions = versions_of(target);
  if (!versions.empty() && versions.back().first >= version) {
    version = versions.back().first;
    ++version.number;
  }
  for (; version.number < max_version_number; ++version.number) {
    fs::path kept = target.parent_path() / version_name(target.stem().string(), version);
    if (::link(target.c_str(), kept.c_str()) == 0) return kept;
    const int error_number = errno;
    if (error_number == ENOENT) return fs::path{};
    if (error_number == EEXIST) continue;
    return Error{Errc::failed, path.string() + ": the earlier version cannot be kept: " +
                                   std::generic_category().message(error_number) +
                                   "; choose a folder that you may write to"};
  }
  return Error{Errc::failed, path.string() + ": " + version.date +
                                 " has too many versions; remove the files of that date"};
}

void drop_oldest_versions(const fs::path& path) {
  const Versions versions = versions_of(target_of(path));
  std::error_code ignored;
  for (std::size_t k = 0; k + max_earlier_versions < versions.size(); ++k)
    fs::remove(versions[k].second, ignored);
}

} // namespace

std::string rfc3339(sys_seconds time) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(time - day);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02dZ",
                static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()),
                static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  return text.data();
}

Result<std::string> calibration_text(const WearerCalibration& wearer) {
  if (const std::string complaint = complaint_about(wearer); !complaint.empty())
    return Error{Errc::bad_input, "this calibration cannot be written: " + complaint};
  std::string text = "# angle_rad = gain_rad_per_count * (count - offset_counts)\n"
                     "version = 1\n"
                     "user = " +
                     toml_string(wearer.user) + "\nhand = \"" + std::string(name_of(wearer.side)) +
                     "\"\nmade = " + rfc3339(wearer.made) +
                     "\nmethod = " + toml_string(wearer.method) +
                     "\nmiddle_bias = " + decimal_text(wearer.calibration.middle_bias) + "\n" +
                     left_out_line(wearer.left_out) + mixed_in_lines(wearer.calibration);
  text += "\n[glove]\nmodel = " + toml_string(wearer.glove_model) +
          "\nserial = " + toml_string(wearer.glove_serial) +
          "\ncounts_most = " + std::to_string(wearer.counts.max_count) +
          "\nwhole_range = " + (wearer.counts.self_calibrated ? "true" : "false") + "\n";
  text += "\n[hand_size]\nlength_m = " + decimal_text(wearer.size.length_m) +
          "\nbreadth_m = " + decimal_text(wearer.size.breadth_m) + "\n" +
          shape_lines(wearer.size.shape) + "\n[sensors]\n";
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& line = wearer.calibration.sensors[slot];
    if (line.gain_rad_per_count == 0.0) continue;
    text += sensor_line(static_cast<Sensor>(slot), line, wearer.quality[slot]);
  }
  return text;
}

Result<WearerCalibration> read_calibration(const fs::path& path) {
  const auto text = read_file(path, max_calibration_bytes, "calibration");
  if (!text) return text.error();
  return parse_calibration(*text, path.string());
}

Result<fs::path> write_calibration(const fs::path& path, const WearerCalibration& wearer) {
  const auto text = calibration_text(wearer);
  if (!text) return text.error();
  std::error_code failed;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), failed);
  if (failed) {
    return Error{Errc::failed, path.parent_path().string() + ": the folder cannot be made: " +
                                   failed.message() + "; make it or choose another"};
  }
  auto kept = keep_as_earlier(path);
  if (!kept) return kept;
  if (const auto written = replace_file(path, *text); !written) {
    if (!kept->empty()) fs::remove(*kept, failed); // the file itself is as it was
    return written.error();
  }
  drop_oldest_versions(path);
  return kept;
}

Result<fs::path> retire_calibration(const fs::path& path) {
  auto kept = keep_as_earlier(path);
  if (!kept) return kept;
  std::error_code failed;
  if (kept->empty() || !fs::remove(path, failed)) {
    std::error_code ignored;
    if (!kept->empty()) fs::remove(*kept, ignored);
    return Error{Errc::failed, path.string() + ": cannot be removed: " +
                                   (failed ? failed.message() : "there is no such file")};
  }
  drop_oldest_versions(path);
  return kept;
}

bool is_earlier_version(const fs::path& path) {
  const std::string stem = path.stem().string(); // NAME.<date>
  const std::size_t dot = stem.rfind('.');
  return dot != std::string::npos &&
         version_of(path.filename().string(), stem.substr(0, dot)).has_value();
}

void move_ends(SensorQuality& quality, double by_counts, CountScale glove) noexcept {
  for (double* const end : {&quality.min_counts, &quality.max_counts})
    *end = std::clamp(*end + by_counts, 0.0, static_cast<double>(glove.max_count));
}

CountRanges reached_ends(const WearerCalibration& wearer) noexcept {
  CountRanges ends;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& quality = wearer.quality[slot];
    if (!quality || !(quality->max_counts > quality->min_counts)) continue;
    ends.present.add(static_cast<Sensor>(slot));
    ends.low_counts[slot] = quality->min_counts;
    ends.high_counts[slot] = quality->max_counts;
  }
  return ends;
}

Calibration calibration_for(const WearerCalibration& wearer, CountScale glove) noexcept {
  Calibration calibration = default_calibration(glove);
  const bool comparable = wearer.counts.self_calibrated == glove.self_calibrated &&
                          wearer.counts.max_count > 0 && glove.max_count > 0;
  if (!comparable) return calibration;
  const double scale = static_cast<double>(glove.max_count) / wearer.counts.max_count;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& line = wearer.calibration.sensors[slot];
    if (line.gain_rad_per_count == 0.0) continue;
    calibration.sensors[slot] = {line.gain_rad_per_count / scale, line.offset_counts * scale};
  }
  calibration.coupling_gains = wearer.calibration.coupling_gains;
  calibration.middle_bias = wearer.calibration.middle_bias;
  return calibration;
}

} // namespace nendo::hand
