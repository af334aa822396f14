#pragma once
// Records the exercise that calibrates a tracker's mount, and says what came of it.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_tracker.hpp>
#include <nendo/hand/tracker_calibration.hpp>
#include <nendo/hand/wearer.hpp>

namespace nendo::calibrate {

struct RecordedExercise {
  std::vector<PoseSample> poses;
  std::vector<hand::WristAngles> wrist; ///< empty without a glove that measures both angles
};

struct ExerciseOptions {
  double countdown_s = 3.0;
  double duration_s = 10.0;
};

/// Returns whether the glove measures both angles of the wrist.
bool measures_wrist(const driver::Glove& glove) noexcept;

/// Starts the tracker and the glove, which may be null, counts down by `note`, records, and stops
/// both. `wearer` calibrates the glove. Ends early when the tracker has ended. Blocks. Errors:
/// those of Tracker::start() and Glove::start(); no_device (no pose comes), failed (a stop signal).
Result<RecordedExercise> record_exercise(const driver::TrackerStation& station,
                                         driver::Glove* glove, const hand::Wearer& wearer,
                                         const ExerciseOptions& options,
                                         const std::function<void(std::string_view)>& note);

/// Returns sentences about the mount, its accuracy and the time offset, one a line.
std::vector<std::string> exercise_report(const hand::TrackerCalibration& made);

} // namespace nendo::calibrate
