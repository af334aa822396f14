#pragma once
// Opens trackers from typed specifications, each of which names one station of a tracker:
//   fastrak:/dev/ttyUSB2?station=1   vrpn:Tracker0@host?sensor=0   osc:9000/left   sim:orbit
//   serve:?hand=left

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/device_spec.hpp>
#include <nendo/driver/tracker.hpp>

namespace nendo::driver {

/// The driver of a kind of tracker.
struct TrackerDriver {
  std::string_view kind;    ///< the part before the colon
  std::string_view grammar; ///< the grammar in `--help`
  std::string_view summary; ///< the description in `--help`
  /// Removes the station from the options or the target of `spec`, so that specifications of one
  /// tracker become equal, and returns it. Adds it to the text of `spec` if the user left it out.
  /// May read a file. Errors: usage, those of the file.
  Result<std::uint16_t> (*take_station)(DeviceSpec& spec);
  /// Opens and identifies the tracker, as open_trackers() does. `spec` has no station.
  Result<std::unique_ptr<Tracker>> (*open)(const DeviceSpec& spec,
                                           std::span<const std::uint16_t> stations);
};

/// A station of an open tracker.
struct TrackerStation {
  std::shared_ptr<Tracker> tracker;
  std::uint16_t station = 0;
  /// The specification that names this station, e.g. "fastrak:/dev/ttyUSB2?station=1", also if the
  /// user left the station out. TrackerInfo::source is that of the first station, as typed.
  std::string source;

  /// The names by which the mount of the station is stored. A tracker that another program shares
  /// has the mount that it has there.
  const std::string& mount_source() const noexcept {
    const TrackerInfo& info = tracker->info();
    return info.shared_source.empty() ? source : info.shared_source;
  }
  std::uint16_t mount_station() const noexcept {
    return tracker->info().shared_source.empty() ? station : tracker->info().shared_station;
  }
};

/// Opens the trackers of these specifications, and returns their stations in the same order. A
/// tracker of which several stations are named is opened once. `more` are drivers that a program
/// adds; the library's names take precedence. May block for up to 5 seconds per tracker. Errors:
/// usage (kind, option), no_device (missing, or does not answer like a tracker), no_permission.
NENDO_API Result<std::vector<TrackerStation>>
open_trackers(std::span<const std::string> specs, std::span<const TrackerDriver> more = {});

/// Starts each of these trackers once, with `rings[k]` for `stations[k]`. On an error, stops those
/// that were started. Errors: those of Tracker::start().
NENDO_API Result<void> start_trackers(std::span<const TrackerStation> stations,
                                      std::span<PoseRing* const> rings);

/// Returns the names of the motions of simulated and emulated trackers: rest, orbit, walk, table,
/// cross.
NENDO_API std::vector<std::string_view> wrist_motion_names();

/// Returns the library's drivers, then `more`.
NENDO_API std::vector<TrackerDriver> tracker_drivers(std::span<const TrackerDriver> more = {});

} // namespace nendo::driver
