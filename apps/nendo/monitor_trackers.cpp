// nendo monitor TRACKER...: shows what trackers send, as a page in a terminal or as JSON lines.

#include <algorithm>
#include <chrono>
#include <iostream>
#include <thread>

#include <unistd.h>

#include <nendo/driver/record_counts.hpp>

#include "cli/cli.hpp"
#include "cli/terminal.hpp"
#include "gloves/open_tracker.hpp"
#include "gloves/tracker_screen.hpp"
#include "gloves/tracker_text.hpp"
#include "nendo/tracker_commands.hpp"

namespace nendo::app {
namespace {

using std::chrono::milliseconds;

/// Takes the poses of all stations.
class Monitored {
public:
  Monitored(gloves::StationPoses& poses, const TrackerMonitoring& options)
      : poses_(poses), options_(options), seen_(poses.size()), begin_(HostClock::now()) {}

  bool may_continue() const {
    const bool is_over =
        options_.duration_s > 0.0 && to_seconds(HostClock::now() - begin_) >= options_.duration_s;
    return !cli::stop_requested() && !is_over && (options_.count == 0 || taken_ < options_.count);
  }
  bool have_ended() const noexcept { return poses_.have_ended(); }
  /// Calls `show(const driver::TrackerStation&, const PoseSample&)` for each new pose.
  template <class Show>
  void take(Show&& show) {
    for (std::size_t at = 0; at < poses_.size(); ++at)
      poses_.drain(at, [&](const PoseSample& pose) {
        if (options_.count > 0 && taken_ >= options_.count) return;
        ++taken_;
        seen_[at].add(pose);
        show(poses_[at], pose);
      });
  }
  std::vector<gloves::TrackerPicture> pictures() const {
    std::vector<gloves::TrackerPicture> pictures;
    for (const driver::Tracker* tracker : poses_.trackers()) {
      gloves::TrackerPicture& picture = pictures.emplace_back();
      picture.info = &tracker->info();
      picture.stats = tracker->stats();
      for (std::size_t at = 0; at < poses_.size(); ++at)
        if (poses_[at].tracker.get() == tracker)
          picture.stations.push_back({poses_[at].station, &seen_[at]});
    }
    return pictures;
  }

private:
  gloves::StationPoses& poses_;
  const TrackerMonitoring& options_;
  std::vector<gloves::SeenPoses> seen_; ///< the poses of each station
  HostTime begin_;
  std::uint64_t taken_ = 0;
};

void show_lines(Monitored& monitored) {
  bool ended = false;
  while (monitored.may_continue() && !ended) {
    ended = monitored.have_ended(); // then all that they sent is in the rings
    bool any = false;
    monitored.take([&](const driver::TrackerStation& station, const PoseSample& pose) {
      std::cout << gloves::pose_json(station.source, pose) << '\n';
      any = true;
    });
    if (any) std::cout.flush();
    if (!ended) std::this_thread::sleep_for(milliseconds(2));
  }
}

void show_screen(Monitored& monitored) {
  constexpr milliseconds frame_time{34}; // at most 30 pictures per second
  cli::Terminal terminal;
  std::vector<std::string> lines;
  bool ended = false;
  bool quits = false;
  while (!ended && !quits && monitored.may_continue() && !terminal.is_gone()) {
    ended = monitored.have_ended();
    monitored.take([](const driver::TrackerStation&, const PoseSample&) {});
    const HostTime now = HostClock::now();
    lines = gloves::tracker_lines(monitored.pictures(), now, terminal.has_keys(), terminal.size());
    terminal.draw(lines);
    while (!ended && !quits && !cli::stop_requested() && !terminal.is_gone() &&
           HostClock::now() < now + frame_time) {
      const auto left = std::chrono::ceil<milliseconds>(now + frame_time - HostClock::now());
      quits = terminal.key(left) == 'q';
    }
  }
  terminal.leave();
  for (const auto& line : lines) // the last picture stays
    std::cout << line << '\n';
  std::cout << std::flush;
}

/// On standard error, because standard output has only poses.
void note_counts(const driver::Tracker& tracker) {
  const driver::StreamStats stats = tracker.stats();
  std::string line = tracker.info().source + ": " + driver::in_words(driver::counts_of(stats));
  const auto shortfall = driver::rate_shortfall(tracker.info().rate_hz, stats);
  if (!shortfall.empty()) line += "; " + shortfall;
  cli::note(line);
}

} // namespace

Result<void> monitor_trackers(const TrackerMonitoring& options) {
  auto stations = gloves::open_trackers(options.trackers);
  if (!stations) return stations.error();
  gloves::StationPoses poses(*std::move(stations));
  if (auto started = poses.start(); !started) return started;
  Monitored monitored(poses, options);
  const bool lines = options.json || isatty(STDOUT_FILENO) == 0;
  if (lines) {
    show_lines(monitored);
  } else {
    show_screen(monitored);
  }
  poses.stop();
  if (!lines) return {};
  for (const driver::Tracker* tracker : poses.trackers())
    note_counts(*tracker);
  return {};
}

} // namespace nendo::app
