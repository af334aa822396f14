// nendo info: queries a glove or a tracker.

#include <algorithm>
#include <iostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/text.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/hand/angle_sources.hpp>

#include "cli/cli.hpp"
#include "gloves/glove_json.hpp"
#include "gloves/open_hand.hpp"
#include "gloves/open_tracker.hpp"
#include "gloves/stuck_sensors.hpp"
#include "gloves/tracker_text.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::info_command {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string device; ///< GLOVE or TRACKER
  bool is_tracker = false;
  bool json = false;
};

std::vector<std::string> names_of(SensorMask mask) {
  std::vector<std::string> names;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (mask.has(sensor)) names.emplace_back(name_of(sensor));
  }
  return names;
}

void print_json(const driver::GloveInfo& info, const std::vector<gloves::SensorAtEnd>& at_end) {
  ordered_json ends = ordered_json::object();
  for (const auto& [sensor, count] : at_end)
    ends[std::string(name_of(sensor))] = count;
  ordered_json line = gloves::glove_json(info);
  line["at_end"] = std::move(ends);
  // A device's text need not be UTF-8.
  cli::print_line(line);
}

// Returns the words, separated by blanks, in lines of at most `width` characters.
std::vector<std::string> wrapped(const std::vector<std::string>& words, std::size_t width) {
  std::vector<std::string> lines{""};
  for (const std::string& word : words) {
    std::string& line = lines.back();
    if (!line.empty() && line.size() + 1 + word.size() > width) {
      lines.push_back(word);
    } else {
      line.append(line.empty() ? "" : " ").append(word);
    }
  }
  return lines;
}

std::string abilities_text(const driver::Abilities& can) {
  std::string text;
  for (const auto& [ability, name] : {std::pair{can.wrist_switch, "wrist switch"},
                                      {can.light, "light"},
                                      {can.vibration, "vibration"},
                                      {can.resistance, "resistance"}})
    if (ability) text.append(text.empty() ? "" : ", ").append(name);
  return text.empty() ? "none" : text;
}

std::vector<std::string> angles_from(const hand::AngleSources& sources, hand::AngleSource source) {
  std::vector<std::string> names;
  for (std::size_t n = 0; n < hand::angle_count; ++n) {
    if (sources[n] == source) names.emplace_back(hand::angle_names[n]);
  }
  return names;
}

std::string rate_text(double rate_hz) {
  return rate_hz > 0.0 ? fmt::format("{:.6g} Hz", rate_hz) : "unknown";
}

/// Prints two columns, names and values, that fit 80 characters.
class Columns {
public:
  explicit Columns(const std::vector<driver::DeviceFact>& facts) {
    for (const auto& fact : facts)
      name_width_ = std::max(name_width_, fact.name.size());
  }
  void print(const std::string& name, const std::string& value) const {
    std::string line = printable(name);
    line.resize(name_width_ + 2, ' ');
    std::cout << line << printable(value) << '\n';
  }
  void print_words(std::string name, const std::vector<std::string>& words) const {
    for (const auto& line : wrapped(words, 80 - name_width_ - 2))
      print(std::exchange(name, ""), line);
  }
  void print_sentence(std::string name, const std::string& sentence) const {
    const auto words = fields_of(sentence, sentence.size());
    print_words(std::move(name), {words.begin(), words.end()});
  }
  /// Prints "a, b, c".
  void print_list(std::string name, std::vector<std::string> words) const {
    for (std::size_t at = 0; at + 1 < words.size(); ++at)
      words[at] += ',';
    print_words(std::move(name), words);
  }
  void print_facts(std::string_view device, const std::vector<driver::DeviceFact>& facts) const {
    if (!facts.empty()) std::cout << "\nreported by the " << device << '\n';
    for (const auto& [name, value] : facts)
      print(name, value);
  }

private:
  std::size_t name_width_ = 10;
};

// Prints how many angles of the hand the glove measures, and the others by the rule that estimates
// them.
void print_angles(const Columns& columns, SensorMask sensors) {
  const hand::AngleSources sources = hand::angle_sources(sensors);
  const auto measured = angles_from(sources, hand::AngleSource::measured).size();
  columns.print("angles", std::to_string(measured) + " of " + std::to_string(hand::angle_count) +
                              " measured" +
                              (measured < hand::angle_count ? "; the others are" : ""));
  for (std::size_t n = 0; n < hand::angle_source_count; ++n) {
    const auto source = static_cast<hand::AngleSource>(n);
    const auto names = angles_from(sources, source);
    if (source != hand::AngleSource::measured && !names.empty())
      columns.print_list(std::string(name_of(source)), names);
  }
}

void print_text(const driver::GloveInfo& info, const std::vector<gloves::SensorAtEnd>& at_end) {
  const Columns columns(info.facts);
  const auto sensors = names_of(info.sensors);

  columns.print("source", info.source);
  columns.print("model", info.model);
  columns.print("hand", std::string(name_of(info.side)));
  columns.print("rate", rate_text(info.rate_hz));
  columns.print("counts", fmt::format("0 to {}, {}", info.counts.max_count,
                                      info.counts.self_calibrated ? "straight to fully bent"
                                                                  : "uncalibrated"));
  columns.print("abilities", abilities_text(info.abilities));
  columns.print("sensors", std::to_string(sensors.size()));
  columns.print_list("", sensors);
  print_angles(columns, info.sensors);
  for (const gloves::SensorAtEnd& found : at_end)
    columns.print_sentence("check", gloves::in_words(found));
  columns.print_facts("glove", info.facts);
}

void print_text(const driver::TrackerInfo& info) {
  const Columns columns(info.facts);
  std::vector<std::string> stations;
  for (const std::uint16_t station : info.stations)
    stations.push_back(std::to_string(station));
  columns.print("source", info.source);
  columns.print("model", info.model);
  columns.print_list("stations", std::move(stations));
  columns.print("rate", rate_text(info.rate_hz));
  columns.print("filter",
                info.is_filtered ? "the tracker filters its poses" : "none in the tracker");
  columns.print_sentence("axes", gloves::axes_text(info));
  columns.print_facts("tracker", info.facts);
}

Result<void> info_of_tracker(const Options& options) {
  const auto stations = gloves::open_trackers({&options.device, 1});
  if (!stations) return stations.error();
  const driver::TrackerInfo& info = stations->front().tracker->info();
  options.json ? cli::print_line(gloves::tracker_json(info)) : print_text(info);
  return {};
}

Result<void> info(const Options& options) {
  if (gloves::is_tracker(options.device, options.is_tracker)) return info_of_tracker(options);
  const auto glove = gloves::open_glove(options.device);
  if (!glove) return glove.error();
  const auto at_end = gloves::sensors_at_end(**glove);
  options.json ? print_json((*glove)->info(), at_end) : print_text((*glove)->info(), at_end);
  return {};
}

} // namespace
} // namespace nendo::app::info_command

void nendo::app::add_info(cli::Command& program) {
  using namespace info_command;
  cli::Command command = program.add_command(
      "info", "Queries a glove or a tracker: model, sensors or stations, abilities");
  Options& options = command.on_chosen<Options>(info);
  command.add_option("DEVICE", options.device, std::string(gloves::device_words)).required();
  gloves::add_tracker_flag(command, options.is_tracker);
  command.add_flag("--json", options.json, "One JSON object");
}
