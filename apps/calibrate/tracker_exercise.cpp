#include "calibrate/tracker_exercise.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include <nendo/base/text.hpp>
#include <nendo/hand/joint_angles.hpp>

#include "cli/cli.hpp"
#include "cli/figures.hpp"
#include "gloves/tracker_text.hpp"

namespace nendo::calibrate {
namespace {

constexpr SensorMask wrist_sensors = mask_of(std::array{Sensor::wrist_pitch, Sensor::wrist_yaw});

bool has_all(SensorMask mask, SensorMask wanted) noexcept {
  return (mask.bits & wanted.bits) == wanted.bits;
}

/// The open devices while the exercise lasts.
class ExerciseRecorder {
public:
  ExerciseRecorder(const driver::TrackerStation& station, driver::Glove* glove,
                   const hand::Wearer& wearer)
      : station_(station), glove_(glove), calibration_(wearer) {}
  ~ExerciseRecorder() {
    station_.tracker->stop();
    if (glove_ != nullptr) glove_->stop();
  }
  ExerciseRecorder(const ExerciseRecorder&) = delete;
  ExerciseRecorder& operator=(const ExerciseRecorder&) = delete;

  Result<void> start() {
    PoseRing* const ring = &poses_;
    if (auto started = driver::start_trackers({&station_, 1}, {&ring, 1}); !started) return started;
    return glove_ == nullptr ? Result<void>() : glove_->start(samples_);
  }
  /// Takes what has come since the last call, or, without `exercise`, drops it.
  void take(RecordedExercise* exercise) {
    PoseSample pose;
    while (poses_.try_pop(pose))
      if (exercise != nullptr) exercise->poses.push_back(pose);
    GloveSample sample;
    while (samples_.try_pop(sample))
      take(sample, exercise);
  }
  bool has_ended() const noexcept { return station_.tracker->has_ended(); }

private:
  void take(const GloveSample& sample, RecordedExercise* exercise) {
    const hand::Calibration& calibration = calibration_.follow(sample);
    const SensorMask left_out = calibration_.left_out(sample);
    const bool is_stuck = (left_out.bits & wrist_sensors.bits) != 0;
    if (exercise == nullptr || is_stuck || !has_all(sample.present, wrist_sensors)) return;
    const hand::JointAngles angles = hand::joint_angles(sample, calibration, left_out);
    exercise->wrist.push_back({sample.time(), angles.wrist_pitch_rad, angles.wrist_yaw_rad});
  }

  const driver::TrackerStation& station_;
  driver::Glove* const glove_;
  hand::ActiveCalibration calibration_;
  PoseRing poses_{4096};
  SampleRing samples_{4096};
};

/// Returns a length with a tenth of a millimetre, and zero without a sign.
std::string tenths(double length_mm) {
  return cli::fixed(std::round(10.0 * length_mm) / 10.0 + 0.0, 1);
}

/// Waits for so long, and notes each second that is left. Returns false at a stop signal.
bool wait_and_count(ExerciseRecorder& recorder, double duration_s, RecordedExercise* exercise,
                    const std::function<void(int)>& note_left) {
  constexpr std::chrono::milliseconds period{20};
  const HostTime end = HostClock::now() + from_seconds(duration_s);
  int left_s = static_cast<int>(std::ceil(duration_s)) + 1;
  for (HostTime now = HostClock::now(); now < end; now = HostClock::now()) {
    if (cli::stop_requested()) return false;
    if (const int left = static_cast<int>(std::ceil(to_seconds(end - now))); left < left_s) {
      left_s = left;
      note_left(left);
    }
    const bool ended = recorder.has_ended(); // then all its poses are in the ring
    recorder.take(exercise);
    if (ended) break;
    std::this_thread::sleep_for(period);
  }
  recorder.take(exercise);
  return true;
}

std::string time_offset_text(const hand::TrackerCalibration& made) {
  const hand::TrackerCalibrationReport& report = made.report;
  switch (report.time_offset) {
  case hand::TimeOffset::measured: {
    const double late_ms = 1e3 * made.mount.late_s;
    return "The tracker is " + cli::fixed(std::abs(late_ms), 1) + " ms " +
           (late_ms < 0.0 ? "earlier" : "later") + " than the glove (uncertain by " +
           cli::fixed(report.late_uncertainty_ms, 1) + " ms, correlation " +
           cli::fixed(report.correlation, 2) + ").";
  }
  case hand::TimeOffset::no_wrist_angles:
    return "The time offset is not known, because no glove measures this wrist: it stays 0 ms, and "
           "the forearm's turn is that of a wrist that is straight on average.";
  case hand::TimeOffset::not_alike:
    break;
  }
  return "The time offset is not known, because the glove's wrist does not move as the tracker "
         "does "
         "(correlation " +
         cli::fixed(report.correlation, 2) +
         "): it stays 0 ms. Check that the glove is of this hand and calibrated, and repeat the "
         "exercise with circles of changing speed.";
}

} // namespace

bool measures_wrist(const driver::Glove& glove) noexcept {
  return has_all(glove.info().sensors, wrist_sensors);
}

Result<RecordedExercise> record_exercise(const driver::TrackerStation& station,
                                         driver::Glove* glove, const hand::Wearer& wearer,
                                         const ExerciseOptions& options,
                                         const std::function<void(std::string_view)>& note) {
  ExerciseRecorder recorder(station, glove, wearer);
  if (const auto started = recorder.start(); !started) return started.error();
  RecordedExercise exercise;
  const Error interrupted{Errc::failed, "interrupted during the exercise; nothing was written"};
  const auto note_start = [&](int left) { note("begin in " + std::to_string(left)); };
  if (!wait_and_count(recorder, options.countdown_s, nullptr, note_start)) return interrupted;
  note("begin now");
  const auto note_rest = [&](int left) {
    if (left % 5 == 0 || left < 4) note(std::to_string(left) + " s to go");
  };
  if (!wait_and_count(recorder, options.duration_s, &exercise, note_rest)) return interrupted;
  if (exercise.poses.empty())
    return Error{Errc::no_device,
                 printable(station.source) + ": no pose came; " + gloves::no_pose_advice(station)};
  return exercise;
}

std::vector<std::string> exercise_report(const hand::TrackerCalibration& made) {
  const hand::TrackerCalibrationReport& report = made.report;
  const std::string poses = std::to_string(report.poses_used) + " poses were used, and " +
                            std::to_string(report.poses_dropped) + " dropped.";
  if (made.mount.on_hand)
    return {"The station on the hand has its turn. The wrist is taken to be where the station is.",
            poses};
  const Eigen::Vector3d centre_mm = 1e3 * made.mount.T_station_wrist.translation();
  return {"The wrist is " + cli::fixed(centre_mm.norm(), 0) + " mm from the station: x " +
              tenths(centre_mm.x()) + ", y " + tenths(centre_mm.y()) + ", z " +
              tenths(centre_mm.z()) + " mm (uncertain by " +
              cli::fixed(report.centre_uncertainty_mm, 1) + " mm).",
          "Residual: " + cli::fixed(report.residual_mm, 1) +
              " mm. The forearm's cone: " + cli::fixed(report.cone_deg, 0) +
              " degrees (condition " + cli::fixed(report.condition, 1) + "). " + poses,
          time_offset_text(made)};
}

} // namespace nendo::calibrate
