#pragma once
// Opens trackers for the commands that look at devices, whose argument is a glove or a tracker.

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_tracker.hpp>

#include "cli/command.hpp"

namespace nendo::gloves {

/// Returns whether an argument for a device is a TRACKER: its kind is one of trackers and not one
/// of gloves, or it is `sim` with a motion that only trackers have. An argument that can be both,
/// such as `replay` and `serve`, is a TRACKER if the user says it (--tracker, `is_said`).
bool is_tracker(std::string_view spec, bool is_said);

/// Adds the flag --tracker, which sets `is_said`.
void add_tracker_flag(cli::Command& command, bool& is_said);
/// The summary of an argument that is a GLOVE or a TRACKER.
inline constexpr std::string_view device_words =
    "A GLOVE or a TRACKER, as for nendo run: serial:/dev/ttyUSB0, sim, auto, sim:orbit, ...";

/// Returns the specifications by which a serial port can be tried as a tracker, such as
/// fastrak:/dev/ttyUSB0. The identity of a USB adapter does not show which
/// tracker is behind it.
std::vector<std::string> tracker_specs_of_port(const std::string& port);

/// Opens the trackers as driver::open_trackers() does, also from recordings, for a command that a
/// stop signal ends. If such a signal comes meanwhile, that is the error: failed, "interrupted".
Result<std::vector<driver::TrackerStation>> open_trackers(std::span<const std::string> specs);

/// The poses of stations as they come. One thread.
class StationPoses {
public:
  explicit StationPoses(std::vector<driver::TrackerStation> stations);
  ~StationPoses() { stop(); }
  StationPoses(const StationPoses&) = delete;
  StationPoses& operator=(const StationPoses&) = delete;

  /// Blocks, and fails, as Tracker::start() does.
  Result<void> start();
  /// Blocks as Tracker::stop() does. Idempotent.
  void stop() noexcept;
  /// Passes each new pose of the station with this index to `take(const PoseSample&)`.
  template <class Take>
  void drain(std::size_t station, Take&& take) {
    PoseSample pose;
    while (rings_[station]->try_pop(pose))
      take(pose);
  }
  std::size_t size() const noexcept { return stations_.size(); }
  const driver::TrackerStation& operator[](std::size_t station) const noexcept {
    return stations_[station];
  }
  /// Returns each tracker once.
  const std::vector<const driver::Tracker*>& trackers() const noexcept { return trackers_; }
  /// Returns whether no more poses will come; all of them are then in the rings, or were taken.
  bool have_ended() const noexcept;

private:
  std::vector<std::unique_ptr<PoseRing>> rings_; ///< outlive the trackers, whose threads write
  std::vector<driver::TrackerStation> stations_;
  std::vector<const driver::Tracker*> trackers_;
};

} // namespace nendo::gloves
