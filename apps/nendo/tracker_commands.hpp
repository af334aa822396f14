#pragma once
// What the commands that look at devices do with a TRACKER.

#include <string>
#include <vector>

#include <nendo/base/result.hpp>

#include "doctor/doctor.hpp"

namespace nendo::app {

struct TrackerMonitoring {
  std::vector<std::string> trackers; ///< each a station
  bool json = false;
  std::uint64_t count = 0; ///< poses to show; 0: no end
  double duration_s = 0.0; ///< 0: no end
};
/// `nendo monitor TRACKER...`: shows the poses of these stations, as a page in a terminal or as
/// JSON lines, and at the end the counts. Blocks until a stop signal, the end of a recording, or
/// the end that is asked for. Errors: those of driver::open_trackers() and of Tracker::start().
Result<void> monitor_trackers(const TrackerMonitoring& options);

/// `nendo doctor TRACKER`: opens it and looks at a second of its poses. Blocks for some seconds.
/// Errors: the same.
Result<doctor::Examination> check_tracker(const std::string& spec);

} // namespace nendo::app
