#include "gloves/open_tracker.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/simulated_glove.hpp>
#include <nendo/recording/replay_driver.hpp>

#include "cli/cli.hpp"
#include "gloves/open_hand.hpp"

namespace nendo::gloves {
namespace {

bool is_glove_motion(std::string_view motion) {
  const auto own = driver::motion_names();
  const auto planned = glove_context().motions;
  return std::ranges::find(own, motion) != own.end() ||
         std::ranges::any_of(planned, [&](const auto& one) { return one.name == motion; });
}

bool is_only_tracker_motion(std::string_view motion) {
  const auto motions = driver::wrist_motion_names();
  return std::ranges::find(motions, motion) != motions.end() && !is_glove_motion(motion);
}

} // namespace

bool is_tracker(std::string_view spec, bool is_said) {
  const auto parsed = driver::parse_device_spec(spec);
  if (is_said || !parsed) return is_said;
  const auto is_kind = [&](const auto& one) { return one.kind == parsed->kind; };
  const bool can_be_tracker = std::ranges::any_of(tracker_drivers(), is_kind);
  const bool can_be_glove = std::ranges::any_of(driver::glove_drivers(glove_context()), is_kind);
  return can_be_tracker && (!can_be_glove || is_only_tracker_motion(parsed->target));
}

void add_tracker_flag(cli::Command& command, bool& is_said) {
  command.add_flag("--tracker", is_said,
                   "It is a TRACKER, where it can be both: sim, serve, replay:FILE");
}

std::vector<std::string> tracker_specs_of_port(const std::string& port) {
  std::vector<std::string> specs;
  for (const driver::TrackerDriver& driver : tracker_drivers()) {
    const std::string kind = std::string(driver.kind) + ":";
    if (driver.grammar.starts_with(kind + "PATH")) specs.push_back(kind + port);
  }
  return specs;
}

Result<std::vector<driver::TrackerStation>> open_trackers(std::span<const std::string> specs) {
  cli::install_stop_signals();
  const std::array more{recording::replay_tracker_driver()};
  auto stations = driver::open_trackers(specs, more);
  if (cli::stop_requested())
    return Error{Errc::failed, specs.front() + ": interrupted while its tracker was being "
                                               "identified"};
  return stations;
}

StationPoses::StationPoses(std::vector<driver::TrackerStation> stations)
    : stations_(std::move(stations)) {
  constexpr std::size_t ring_size = 1024;
  for (const driver::TrackerStation& station : stations_) {
    rings_.push_back(std::make_unique<PoseRing>(ring_size));
    if (std::ranges::find(trackers_, station.tracker.get()) == trackers_.end())
      trackers_.push_back(station.tracker.get());
  }
}

Result<void> StationPoses::start() {
  std::vector<PoseRing*> rings;
  for (const auto& ring : rings_)
    rings.push_back(ring.get());
  return driver::start_trackers(stations_, rings);
}

void StationPoses::stop() noexcept {
  for (const driver::TrackerStation& station : stations_)
    station.tracker->stop();
}

bool StationPoses::have_ended() const noexcept {
  return std::ranges::all_of(trackers_, [](const auto* tracker) { return tracker->has_ended(); });
}

} // namespace nendo::gloves
