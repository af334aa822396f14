// nendo monitor: shows what a glove sends, as live bars in a terminal or as JSON lines, or what
// trackers send.

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>

#include <nendo/base/text.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/record_counts.hpp>
#include <nendo/hand/wearer.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "cli/cli.hpp"
#include "cli/quantities.hpp"
#include "cli/terminal.hpp"
#include "gloves/glove_feedback.hpp"
#include "gloves/glove_json.hpp"
#include "gloves/monitor_screen.hpp"
#include "gloves/open_hand.hpp"
#include "gloves/open_tracker.hpp"
#include "gloves/stuck_sensors.hpp"
#include "nendo/commands.hpp"
#include "nendo/tracker_commands.hpp"

namespace nendo::app::monitor_command {
namespace {

struct Options {
  std::vector<std::string> devices; ///< one GLOVE, or TRACKERs
  bool are_trackers = false;
  bool json = false;
  bool raw = false;
  std::uint64_t count = 0;
  double duration_s = 0.0; ///< 0: no end
  gloves::CalibrationOptions calibration;
};

/// Takes the samples of a glove and finds the calibration for each.
struct Monitored {
  driver::Glove& glove;
  SampleRing& ring;
  const hand::Wearer* wearer;                ///< null: counts only
  hand::ActiveCalibration& calibrations;     ///< those of `wearer`, or an average hand's
  const sculpting::FoundCalibration& found;  ///< what was found for the glove's own hand
  std::uint64_t max_shown;                   ///< samples to show; 0: no end
  std::optional<HostTime> end;               ///< nothing: no end
  const hand::Calibration* active = nullptr; ///< that of the latest sample; null: none
  SensorMask left_out{};                     ///< with the latest sample
  gloves::StuckNotices stuck{};
  std::vector<std::string> news{}; ///< what the latest sample shows of stuck sensors
  std::uint64_t shown = 0;

  bool may_continue() const {
    return !cli::stop_requested() && (!end || HostClock::now() < *end) &&
           (max_shown == 0 || shown < max_shown);
  }
  bool next(GloveSample& sample) {
    if (!may_continue() || !ring.try_pop(sample)) return false;
    const hand::Calibration& followed = calibrations.follow(sample);
    if (wearer != nullptr) active = &followed;
    left_out = calibrations.left_out(sample);
    news = stuck.changes(left_out, &sample);
    ++shown;
    return true;
  }
  /// Returns the calibration of a sample of that side; null: unknown, because another glove was
  /// plugged in.
  const sculpting::FoundCalibration* found_for(Side side) const {
    return side == glove.info().side ? &found : nullptr;
  }
  std::string wearer_of(Side side) const {
    const auto* known = found_for(side);
    if (wearer == nullptr || known == nullptr) return {};
    using Kind = sculpting::FoundCalibration::Kind;
    if (known->kind == Kind::recorded) return "the wearer who was recorded";
    if (known->kind == Kind::average)
      return glove.info().kind == driver::SourceKind::recorded ? "an average hand" : "";
    return known->user;
  }
  bool is_uncalibrated(Side side) const {
    return wearer != nullptr && sculpting::is_uncalibrated(glove.info(), *wearer, side);
  }
};

void show_lines(Monitored& monitored) {
  GloveSample sample;
  gloves::GloveChanges gloves;
  bool ended = false;
  while (monitored.may_continue() && !ended) {
    ended = monitored.glove.has_ended(); // then all that it sent is in the ring
    bool any = false;
    for (; monitored.next(sample); any = true) {
      const bool first = gloves.is_first(sample.side, sample.present, monitored.left_out);
      const auto* found = monitored.found_for(sample.side);
      std::cout << gloves::sample_json(sample, monitored.active, first, found, monitored.left_out)
                << '\n';
      for (const std::string& sentence : monitored.news)
        cli::note(monitored.glove.info().source + ": " + sentence);
    }
    if (any) std::cout.flush();
    if (!ended) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// Reports losses on standard error, because standard output has only samples.
void note_losses(const driver::Glove& glove) {
  const auto stats = glove.stats();
  const auto counts = driver::counts_of(stats);
  if (counts.missed + counts.refused + counts.bad + counts.clamped > 0)
    cli::note(glove.info().source + ": " + driver::in_words(counts));
  if (const auto shortfall = driver::rate_shortfall(glove.info().rate_hz, stats);
      !shortfall.empty())
    cli::note(glove.info().source + ": " + shortfall + "; the others did not arrive");
}

/// Returns false if the user wants to end.
bool handle(char key, gloves::SeenCounts& seen, gloves::GloveFeedback& light) {
  if (key == 'r') seen.clear();
  if (key == 'l') light.show(!light.is_lit());
  return key != 'q';
}

void show_screen(Monitored& monitored) {
  constexpr std::chrono::milliseconds frame_time{34}; // at most 30 pictures per second
  cli::Terminal terminal;
  gloves::GloveFeedback light(monitored.glove);
  gloves::SeenCounts seen;
  GloveSample sample;
  bool any = false;
  std::vector<std::string> lines;
  bool continues = true;
  bool ended = false;
  while (continues && !ended && monitored.may_continue() && !terminal.is_gone()) {
    ended = monitored.glove.has_ended(); // then all that it sent is in the ring
    for (; monitored.next(sample); any = true)
      seen.add(sample);
    const HostTime now = HostClock::now();
    const gloves::MonitorPicture picture{&monitored.glove.info(),
                                         monitored.glove.stats(),
                                         any ? &sample : nullptr,
                                         &seen,
                                         monitored.active,
                                         to_seconds(now - sample.arrival),
                                         light.is_lit(),
                                         terminal.has_keys(),
                                         any && monitored.is_uncalibrated(sample.side),
                                         any ? monitored.wearer_of(sample.side) : "",
                                         monitored.left_out};
    lines = gloves::monitor_lines(picture, terminal.size());
    if (terminal.is_plain() &&
        lines.size() > 2) { // the bars would be about twenty lines per second
      terminal.draw({lines[0], lines[1]});
    } else {
      terminal.draw(lines);
    }
    while (continues && !ended && !cli::stop_requested() && !terminal.is_gone() &&
           HostClock::now() < now + frame_time) {
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(now + frame_time - HostClock::now());
      if (const auto key = terminal.key(left)) continues = handle(*key, seen, light);
    }
  }
  terminal.leave();
  for (const auto& line : lines) // the last picture stays
    std::cout << line << '\n';
  std::cout << std::flush;
  light.put_out();
}

Result<void> monitor_glove(const Options& options) {
  const auto glove = gloves::open_glove(options.devices.front());
  if (!glove) return glove.error();
  std::optional<hand::Wearer> wearer;
  sculpting::FoundCalibration whose;
  if (!options.raw) {
    const auto found = sculpting::find_wearer((*glove)->info(), (*glove)->info().side,
                                              options.calibration, cli::note, &whose);
    if (!found) return found.error();
    wearer = *found;
  }
  hand::Wearer counts_only;
  counts_only.watched = (*glove)->info().counts;
  hand::ActiveCalibration calibrations(wearer ? *wearer : counts_only);
  SampleRing ring(1024);
  cli::install_stop_signals();
  if (const auto started = (*glove)->start(ring); !started) return started.error();

  Monitored monitored{**glove,       ring,        wearer ? &*wearer : nullptr, calibrations, whose,
                      options.count, std::nullopt};
  if (options.duration_s > 0.0) monitored.end = HostClock::now() + from_seconds(options.duration_s);
  const bool lines = options.json || isatty(STDOUT_FILENO) == 0;
  if (lines) {
    show_lines(monitored);
  } else {
    show_screen(monitored);
  }
  (*glove)->stop();
  if (lines) note_losses(**glove);
  return {};
}

Result<void> monitor(const Options& options) {
  if (auto fine = gloves::check(options.calibration); !fine) return fine;
  if (auto fine = cli::check_duration(options.duration_s); !fine) return fine;
  const bool are_trackers = std::ranges::any_of(options.devices, [&](const std::string& device) {
    return gloves::is_tracker(device, options.are_trackers);
  });
  if (are_trackers)
    return monitor_trackers({options.devices, options.json, options.count, options.duration_s});
  if (options.devices.size() == 1) return monitor_glove(options);
  return Error{Errc::usage, "DEVICE: takes one glove, or several trackers; for " +
                                printable(options.devices[1]) + " use a second terminal"};
}

} // namespace
} // namespace nendo::app::monitor_command

void nendo::app::add_monitor(cli::Command& program) {
  using namespace monitor_command;
  cli::Command command =
      program.add_command("monitor", "Shows what a glove or trackers send: live in a terminal, "
                                     "JSON lines when piped or asked for");
  Options& options = command.on_chosen<Options>(monitor);
  command.set_footer(
      "In a bar, # shows the count, and [ ] the min and max so far.\n"
      "A ~ before degrees: the glove is uncalibrated, and they are those of an average hand.\n"
      "An e before degrees: the sensor is stuck, and its angle is estimated from its "
      "neighbours.\n"
      "Keys: q quit, r reset the ranges, l light on and off.\n"
      "Of a tracker's station: the position in millimetres, the turn in degrees (about z by the\n"
      "azimuth, then about y by the elevation, then about x by the roll), and the error letter.\n"
      "It ends with Ctrl-C, with --count or --duration, and when a recording (replay:FILE) ends.\n"
      "\"missed\" records were lost on the line; \"refused\" ones did not fit into this program's\n"
      "buffer. If losses cannot be counted, the rate is shown if it is too low. Values out of "
      "range\n"
      "are clamped.");
  command
      .add_option("DEVICE", options.devices,
                  "A GLOVE, or a TRACKER or several, as for nendo run: serial:/dev/ttyUSB0, sim, "
                  "auto, sim:orbit, ...")
      .required();
  gloves::add_tracker_flag(command, options.are_trackers);
  command.add_flag("--json", options.json, "One JSON object per line, also in a terminal");
  command.add_flag("--raw", options.raw, "Raw counts only, no angles");
  gloves::add_calibration_options(command, options.calibration, false);
  command.add_option("--count", options.count, "End after this number of samples or poses");
  command.add_duration("--duration", options.duration_s, "End after this time, e.g. 10s");
}
