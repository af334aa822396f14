// nendo monitor: what a glove sends, as live bars in a terminal or as JSON lines.

#include <cstdint>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <thread>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include <nendo/driver/open_glove.hpp>
#include <nendo/hand/calibration.hpp>

#include "cli.hpp"

namespace nendo::app {
namespace {

struct Options {
  std::string glove;
  bool json = false;
  bool raw = false;
  std::uint64_t count = 0;
};

std::string json_line(const GloveSample& sample, const hand::Calibration& calibration,
                      bool raw_only) {
  nlohmann::ordered_json raw = nlohmann::ordered_json::object();
  nlohmann::ordered_json angles = nlohmann::ordered_json::object();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (!sample.present.has(sensor)) continue;
    raw[std::string(name_of(sensor))] = sample[sensor].value;
    angles[std::string(name_of(sensor))] = calibration[sensor].angle_rad(sample[sensor]);
  }
  nlohmann::ordered_json line{{"time_s", to_seconds(sample.arrival.time_since_epoch())},
                              {"sequence", sample.sequence},
                              {"hand", name_of(sample.side)},
                              {"raw", std::move(raw)}};
  if (sample.has_device_time) line["device_time_s"] = to_seconds(sample.device_time);
  if (!raw_only) line["angle_rad"] = std::move(angles);
  return line.dump();
}

// 22 sensors and two lines of heading fit a terminal of 24 lines, if the last does not end in a new
// line.
std::string screen(const GloveSample& sample, const driver::GloveInfo& info,
                   const driver::GloveStats& stats, const hand::Calibration& calibration) {
  constexpr int bar_width = 32;
  std::ostringstream out;
  out << "\x1b[H" << info.source << ": " << info.model << ", " << name_of(sample.side)
      << " hand\x1b[K\n"
      << stats.records << " records, " << stats.bad_records << " bad, " << stats.ring_refused
      << " lost; Ctrl-C ends\x1b[K";
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (!sample.present.has(sensor)) continue;
    const int filled = std::min(bar_width, sample[sensor].value * bar_width / 255);
    out << '\n'
        << std::left << std::setw(23) << name_of(sensor) << std::right << std::setw(4)
        << sample[sensor].value << ' ' << std::string(static_cast<std::size_t>(filled), '#')
        << std::string(static_cast<std::size_t>(bar_width - filled), '.') << std::setw(6)
        << std::fixed << std::setprecision(2) << calibration[sensor].angle_rad(sample[sensor])
        << " rad\x1b[K";
  }
  return out.str() + "\x1b[J";
}

int monitor(const Options& options) {
  auto glove = driver::open_glove(options.glove);
  if (!glove) return report(glove.error());
  SampleRing ring(1024);
  install_stop_signals();
  if (const auto started = (*glove)->start(ring); !started) return report(started.error());

  const bool json = options.json || isatty(STDOUT_FILENO) == 0;
  const hand::Calibration calibration = hand::default_calibration();
  std::uint64_t shown = 0;
  const auto wanted = [&] {
    return !stop_requested() && (options.count == 0 || shown < options.count);
  };
  if (!json) std::cout << "\x1b[2J";
  while (wanted() && std::cout) {
    GloveSample sample;
    bool any = false;
    while (wanted() && ring.try_pop(sample)) {
      any = true;
      ++shown;
      if (json) std::cout << json_line(sample, calibration, options.raw) << '\n';
    }
    if (any && !json) std::cout << screen(sample, (*glove)->info(), (*glove)->stats(), calibration);
    if (any) std::cout.flush();
    std::this_thread::sleep_for(std::chrono::milliseconds(json ? 2 : 33));
  }
  (*glove)->stop();
  if (!json) std::cout << std::endl;
  return 0;
}

} // namespace

void add_monitor(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App& command = *app.add_subcommand(
      "monitor",
      "Shows what a glove sends: bars in a terminal, JSON lines when piped or asked for");
  command.add_option("GLOVE", options->glove, "serial:/dev/ttyUSB0, sim, auto, ...")->required();
  command.add_flag("--json", options->json, "One JSON object a line, also in a terminal");
  command.add_flag("--raw", options->raw, "Raw counts only, no angles");
  command.add_option("--count", options->count, "End after so many samples");
  on_chosen(command, exit_code, [options] { return monitor(*options); });
}

} // namespace nendo::app
