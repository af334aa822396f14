#include "calibrate/capture_file.hpp"

#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include <nlohmann/json.hpp>

#include <nendo/base/files.hpp>

namespace nendo::calibrate {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::uintmax_t max_bytes = 1U << 30U;

std::optional<double> number(const json& object, const char* key, double least, double most) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return value >= least && value <= most ? std::optional(value) : std::nullopt;
}

/// Calls `take(slot, value)` for each sensor of an object of counts. Returns false if it is no such
/// object.
template <class Take>
bool for_each_count(const json& line, const char* key, double most, Take&& take) {
  const auto counts = line.find(key);
  if (counts == line.end() || !counts->is_object() || counts->empty()) return false;
  for (const auto& [name, value] : counts->items()) {
    const auto sensor = sensor_named(name);
    if (!sensor || !value.is_number()) return false;
    const double count = value.template get<double>();
    if (!(count >= 0.0 && count <= most)) return false;
    take(index_of(*sensor), count);
  }
  return true;
}

bool read_sample(const json& line, GloveSample& sample) {
  const auto time_s = number(line, line.contains("measured_s") ? "measured_s" : "time_s", 0.0, 1e9);
  if (!time_s) return false;
  sample.arrival = HostTime(from_seconds(*time_s));
  sample.measured = sample.arrival;
  return for_each_count(line, "raw", 65535.0, [&](std::size_t slot, double count) {
    sample.set(static_cast<Sensor>(slot), RawCount{static_cast<std::uint16_t>(count)});
  });
}

bool read_scale(const json& line, CountScale& counts) {
  const auto max = number(line, "counts_most", 1.0, 65535.0);
  if (!max) return false;
  counts = {static_cast<std::uint16_t>(*max), line.value("whole_range", json(false)) == true};
  return true;
}

bool read_reading(const json& line, hand::PoseReading& reading, CountScale& counts) {
  const auto pose =
      line["pose"].is_string() ? hand::pose_named(line["pose"].get<std::string>()) : std::nullopt;
  if (!pose || !read_scale(line, counts)) return false;
  reading.pose = *pose;
  hand::HeldPose& held = reading.held;
  const bool noise =
      for_each_count(line, "noise_counts", counts.max_count,
                     [&](std::size_t slot, double n) { held.noise_counts[slot] = n; });
  return noise &&
         for_each_count(line, "mean_counts", counts.max_count, [&](std::size_t slot, double n) {
           held.mean_counts[slot] = n;
           held.present.add(static_cast<Sensor>(slot));
         });
}

bool read_free_motion(const json& line, hand::CountRanges& motion, CountScale& counts) {
  if (!read_scale(line, counts)) return false;
  SensorMask high;
  const bool low =
      for_each_count(line, "low_counts", counts.max_count, [&](std::size_t slot, double n) {
        motion.low_counts[slot] = n;
        motion.present.add(static_cast<Sensor>(slot));
      });
  return low &&
         for_each_count(line, "high_counts", counts.max_count,
                        [&](std::size_t slot, double n) {
                          motion.high_counts[slot] = n;
                          high.add(static_cast<Sensor>(slot));
                        }) &&
         high == motion.present;
}

std::optional<Side> hand_of(const json& line) {
  const auto found = line.find("hand");
  for (const Side side : {Side::left, Side::right})
    if (found != line.end() && *found == name_of(side)) return side;
  return std::nullopt;
}

constexpr std::string_view use_monitor = "; use what `nendo monitor GLOVE --json` prints";

/// Reads a line into `file`. Returns what is wrong with the line, or an empty text.
std::string take_line(const std::string& text, CaptureFile& file, bool first) {
  const json line = json::parse(text, nullptr, false);
  if (!line.is_object()) return "not a JSON object" + std::string(use_monitor);
  const auto side = hand_of(line);
  if (!side) return "no \"hand\" that is left or right" + std::string(use_monitor);
  if (!first && *side != file.side) return "the other hand; use one file for each";
  file.side = *side;
  if (line.contains("low_counts"))
    return read_free_motion(line, file.free_motion, file.counts) ? "" : "not a free motion's ends";
  if (line.contains("pose")) {
    hand::PoseReading reading;
    if (!read_reading(line, reading, file.counts)) return "not a held pose with its counts";
    file.readings.push_back(reading);
    return {};
  }
  GloveSample sample;
  sample.side = *side;
  if (!read_sample(line, sample))
    return "neither a sample with its time and counts nor a pose" + std::string(use_monitor);
  file.samples.push_back(sample);
  return {};
}

ordered_json counts_json(SensorMask present, const std::array<double, sensor_slots>& counts) {
  ordered_json object = ordered_json::object();
  for (const Sensor sensor : present)
    object[std::string(name_of(sensor))] = counts[index_of(sensor)];
  return object;
}

} // namespace

Result<CaptureFile> read_capture(const std::filesystem::path& path) {
  const auto bad = [&](const std::string& what) {
    return Error{Errc::bad_input, path.string() + ": " + what};
  };
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) return bad(error.message());
  if (size > max_bytes) return bad("larger than 1 GiB; that is no capture of a calibration");
  std::ifstream input(path);
  CaptureFile file;
  std::string text;
  for (std::size_t number = 1; std::getline(input, text); ++number) {
    if (text.empty()) continue;
    const bool first = file.is_empty();
    const std::string wrong = take_line(text, file, first);
    if (!wrong.empty())
      return Error{Errc::bad_input, path.string() + ":" + std::to_string(number) + ": " + wrong};
  }
  if (input.bad()) return bad("cannot be read");
  if (file.is_empty()) return bad("there is nothing in it" + std::string(use_monitor));
  return file;
}

Result<void> write_readings(const std::filesystem::path& path,
                            std::span<const hand::PoseReading> readings,
                            const hand::CountRanges& free_motion, Side side, CountScale counts) {
  std::string text;
  const auto add = [&](ordered_json line) {
    line["hand"] = name_of(side);
    line["counts_most"] = counts.max_count;
    line["whole_range"] = counts.self_calibrated;
    text += line.dump() + "\n";
  };
  if (free_motion.present.bits != 0)
    add({{"low_counts", counts_json(free_motion.present, free_motion.low_counts)},
         {"high_counts", counts_json(free_motion.present, free_motion.high_counts)}});
  for (const auto& [pose, held] : readings)
    add({{"pose", hand::pose_of(pose).name},
         {"mean_counts", counts_json(held.present, held.mean_counts)},
         {"noise_counts", counts_json(held.present, held.noise_counts)}});
  return replace_file(path, text);
}

} // namespace nendo::calibrate
