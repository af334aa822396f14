#include <nendo/hand/tracker_calibration.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/units.hpp>
#include <nendo/hand/dense.hpp>
#include <nendo/hand/skeleton.hpp>

#include "pivot.hpp"
#include "turn_correlation.hpp"

namespace nendo::hand {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double max_distance_m = 3.0;   // no station of a wrist is farther away
constexpr double max_norm_error = 0.002; // of a quaternion
constexpr std::size_t min_poses = 60;    // usable ones
constexpr double min_duration_s = 4.0;
constexpr double max_duration_s = 120.0;
constexpr double max_dropped_part = 0.4;
constexpr double min_cone_deg = 10.0;     // below, noise and skin move the centre too far
constexpr double min_turn_deg = 3.0;      // below, nothing moved
constexpr double max_hand_turn_deg = 6.0; // of a hand that should be still
constexpr double max_drift_m = 0.006;
constexpr double max_residual_m = 0.020;
constexpr double max_uncertainty_m = 0.005;
constexpr double min_correlation = 0.35;
constexpr double max_late_deviation_s = 0.030;

std::string with_digits(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

Error refused(const std::string& what) {
  return {Errc::bad_input, what};
}

std::optional<StationPose> usable_pose(const PoseSample& sample, HostTime origin) {
  const Vector3d position(sample.position_m[0], sample.position_m[1], sample.position_m[2]);
  const Quaterniond turn(sample.turn_xyzw[3], sample.turn_xyzw[0], sample.turn_xyzw[1],
                         sample.turn_xyzw[2]);
  // Written so that a NaN is refused.
  if (!(position.norm() <= max_distance_m) || !(std::abs(turn.norm() - 1.0) <= max_norm_error))
    return std::nullopt;
  return StationPose{seconds_between(origin, sample.measured), turn.normalized().toRotationMatrix(),
                     position};
}

/// Returns the poses that can be used, in rising order of times.
std::vector<StationPose> usable_poses(std::span<const PoseSample> samples, HostTime origin) {
  std::vector<StationPose> poses;
  for (const PoseSample& sample : samples) {
    const auto pose = usable_pose(sample, origin);
    if (pose && (poses.empty() || pose->time_s > poses.back().time_s)) poses.push_back(*pose);
  }
  return poses;
}

Result<void> check_poses(const std::vector<StationPose>& poses, std::size_t given) {
  if (static_cast<double>(given - poses.size()) > max_dropped_part * static_cast<double>(given))
    return refused(std::to_string(given - poses.size()) + " of " + std::to_string(given) +
                   " poses are no poses (not finite, beyond 3 m, or without a rotation); bring the "
                   "tracker's source nearer, away from metal and screens, and repeat the exercise");
  const double duration_s = poses.empty() ? 0.0 : poses.back().time_s - poses.front().time_s;
  if (duration_s > max_duration_s)
    return refused("the poses cover " + with_digits(duration_s, 0) +
                   " s, and at most two minutes can be used; ten seconds are enough");
  if (poses.size() >= min_poses && duration_s >= min_duration_s) return {};
  return refused("only " + std::to_string(poses.size()) + " poses came in " +
                 with_digits(duration_s, 1) + " s, and " + std::to_string(min_poses) + " in " +
                 with_digits(min_duration_s, 0) +
                 " s are needed; check the tracker with nendo info, and continue for ten seconds");
}

Matrix3d mean_turn(const std::vector<StationPose>& poses) {
  Matrix3d sum = Matrix3d::Zero();
  for (const StationPose& pose : poses)
    sum += pose.turn;
  return nearest_rotation(sum);
}

/// Returns the angle from the mean that one in ten poses exceeds.
double turn_range_deg(const std::vector<StationPose>& poses) {
  const Matrix3d mean = mean_turn(poses);
  std::vector<double> angles;
  for (const StationPose& pose : poses)
    angles.push_back(Eigen::AngleAxisd(Matrix3d(mean.transpose() * pose.turn)).angle());
  const auto at = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() * 9 / 10);
  std::nth_element(angles.begin(), at, angles.end());
  return to_degrees(*at);
}

/// In a circular cone, the weakest directions of the centre are those across the forearm, which
/// half of the tilt determines.
double cone_deg_of(double smallest_singular_value) {
  return to_degrees(std::asin(std::min(std::sqrt(2.0) * smallest_singular_value, 1.0)));
}

Result<void> check_cone(const PivotFit& fit) {
  const double cone_deg = cone_deg_of(fit.smallest_singular_value);
  if (cone_deg >= min_cone_deg) return {};
  constexpr double flat = 4.0; // the ratio of singular values in motions that are no circles
  const bool to_and_fro = fit.largest_singular_value > flat * fit.smallest_singular_value;
  return refused("the forearm's cone of " + with_digits(cone_deg, 0) +
                 " degrees is too small, and at least " + with_digits(min_cone_deg, 0) +
                 " are needed; " +
                 (to_and_fro ? "move the elbow in circles, up and down as well as to the sides"
                             : "draw larger circles with the elbow"));
}

Result<void> check_fit(const PivotFit& fit, std::size_t given) {
  if (auto fine = check_cone(fit); !fine) return fine;
  if (fit.drift_m > max_drift_m)
    return refused("the wrist moved by " + with_digits(1e3 * fit.drift_m, 0) +
                   " mm; keep the hand in its place on the table, and move the elbow alone");
  const std::size_t dropped = given - fit.used.size();
  if (static_cast<double>(dropped) > max_dropped_part * static_cast<double>(given))
    return refused(std::to_string(dropped) + " of " + std::to_string(given) +
                   " poses contradict the others; bring the tracker's source nearer, away from "
                   "metal and screens, and repeat the exercise");
  if (fit.residual_m > max_residual_m)
    return refused("the poses do not turn about one point (" +
                   with_digits(1e3 * fit.residual_m, 0) +
                   " mm RMS); keep the hand still, and fasten the station so that it cannot slip");
  if (fit.centre_deviation_m > max_uncertainty_m)
    return refused("the wrist's centre is uncertain by " +
                   with_digits(1e3 * fit.centre_deviation_m, 0) +
                   " mm; draw larger circles, nearer to the tracker's source");
  return {};
}

/// Returns what the glove says of the seconds of the poses, which begin at `origin`.
std::vector<TimedTurn> wrist_turns(const TrackerExercise& exercise, HostTime origin) {
  const HandSkeleton skeleton(exercise.side);
  std::vector<TimedTurn> turns;
  for (const WristAngles& angles : exercise.wrist) {
    const double time_s = seconds_between(origin, angles.time);
    const bool rises = turns.empty() || time_s > turns.back().time_s;
    if (!rises || time_s < -max_late_s || time_s > max_duration_s) continue;
    JointAngles joints;
    joints.wrist_pitch_rad = angles.pitch_rad;
    joints.wrist_yaw_rad = angles.yaw_rad;
    const HandPose pose = skeleton.pose(joints, Eigen::Isometry3d::Identity());
    turns.push_back({time_s, pose[Joint::wrist].linear().transpose()});
  }
  return turns;
}

/// Returns the turn of `turns` at a time, as a mean of the two beside it.
std::optional<Matrix3d> turn_at(const std::vector<TimedTurn>& turns, double time_s) {
  constexpr double max_gap_s = 0.1;
  const auto after =
      std::lower_bound(turns.begin(), turns.end(), time_s,
                       [](const TimedTurn& turn, double time) { return turn.time_s < time; });
  if (after == turns.begin() || after == turns.end()) return std::nullopt;
  const auto before = after - 1;
  const double gap_s = after->time_s - before->time_s;
  if (gap_s > max_gap_s) return std::nullopt;
  const double part = (time_s - before->time_s) / gap_s;
  return Matrix3d((1.0 - part) * before->turn + part * after->turn);
}

/// Compares tracker and glove, and notes what is found. Returns the match if it can be believed.
std::optional<TurnMatch> match_glove(const TrackerExercise& exercise,
                                     const std::vector<StationPose>& poses,
                                     const std::vector<TimedTurn>& wrist,
                                     TrackerCalibrationReport& report) {
  std::vector<TimedTurn> by_tracker;
  const Matrix3d stage = exercise.stage_from_tracker.normalized().toRotationMatrix();
  for (const StationPose& pose : poses)
    by_tracker.push_back({pose.time_s, stage * pose.turn});
  const auto match = match_turns(by_tracker, wrist);
  if (!match) return std::nullopt;
  report.correlation = match->correlation;
  report.time_offset = TimeOffset::not_alike;
  if (match->correlation < min_correlation || match->late_deviation_s > max_late_deviation_s)
    return std::nullopt;
  report.time_offset = TimeOffset::measured;
  report.late_uncertainty_ms = 1e3 * match->late_deviation_s;
  report.heading_deg = to_degrees(match->heading_rad);
  return match;
}

/// Returns the turn from the forearm to the station: the mean over all poses. `by_wrist`
/// are turns from the forearm to the hand; without them the wrist counts as straight.
Matrix3d station_from_forearm(const std::vector<StationPose>& poses, const Matrix3d& tracker_hand,
                              const std::vector<TimedTurn>& by_wrist, double late_s) {
  Matrix3d sum = Matrix3d::Zero();
  for (const StationPose& pose : poses) {
    const auto hand_forearm =
        by_wrist.empty() ? Matrix3d(Matrix3d::Identity()) : turn_at(by_wrist, pose.time_s - late_s);
    if (hand_forearm) sum.noalias() += pose.turn.transpose() * tracker_hand * *hand_forearm;
  }
  return nearest_rotation(sum);
}

/// Returns the turn from a flat hand with that heading to the tracker.
Matrix3d tracker_from_hand(const TrackerExercise& exercise, double heading_rad) {
  const Matrix3d stage = exercise.stage_from_tracker.normalized().toRotationMatrix();
  return stage.transpose() * Eigen::AngleAxisd(heading_rad, Vector3d::UnitY()).toRotationMatrix();
}

TrackerCalibration begin_calibration(const TrackerExercise& exercise) {
  TrackerCalibration made;
  made.mount.stage_from_tracker = exercise.stage_from_tracker.normalized();
  made.mount.on_hand = exercise.on_hand;
  return made;
}

Result<TrackerCalibration> calibrate_on_hand(const TrackerExercise& exercise,
                                             const std::vector<StationPose>& poses) {
  const double turned_deg = turn_range_deg(poses);
  if (turned_deg > max_hand_turn_deg)
    return refused("the hand turned by " + with_digits(turned_deg, 0) +
                   " degrees; keep it flat and still, or, if the station is on the forearm, "
                   "calibrate it as that");
  TrackerCalibration made = begin_calibration(exercise);
  made.mount.T_station_wrist.linear() =
      station_from_forearm(poses, tracker_from_hand(exercise, 0.0), {}, 0.0);
  made.report.poses_used = poses.size();
  made.report.poses_dropped = exercise.poses.size() - poses.size();
  return made;
}

Result<TrackerCalibration> calibrate_on_forearm(const TrackerExercise& exercise,
                                                const std::vector<StationPose>& poses,
                                                HostTime origin) {
  if (const double turned_deg = turn_range_deg(poses); turned_deg < min_turn_deg)
    return refused("the tracker's station turned by " + with_digits(turned_deg, 1) +
                   " degrees only; fasten this station to the forearm, and draw circles with the "
                   "elbow (a station on the back of the hand has a calibration of its own)");
  const auto fit = fit_pivot(poses);
  if (!fit)
    return refused("the poses determine no point about which the forearm turns; draw circles with "
                   "the elbow, up and down as well as to the sides");
  if (const auto fine = check_fit(*fit, exercise.poses.size()); !fine) return fine.error();
  TrackerCalibration made = begin_calibration(exercise);
  TrackerCalibrationReport& report = made.report;
  report.poses_used = fit->used.size();
  report.poses_dropped = exercise.poses.size() - fit->used.size();
  report.residual_mm = 1e3 * fit->residual_m;
  report.cone_deg = cone_deg_of(fit->smallest_singular_value);
  report.smallest_singular_value = fit->smallest_singular_value;
  report.condition = fit->largest_singular_value / fit->smallest_singular_value;
  report.centre_uncertainty_mm = 1e3 * fit->centre_deviation_m;

  std::vector<TimedTurn> wrist = wrist_turns(exercise, origin);
  const auto match = match_glove(exercise, fit->used, wrist, report);
  if (!match) wrist.clear();
  made.mount.late_s = match ? match->late_s : 0.0;
  made.mount.T_station_wrist.translation() = fit->centre_m;
  made.mount.T_station_wrist.linear() =
      station_from_forearm(fit->used, tracker_from_hand(exercise, match ? match->heading_rad : 0.0),
                           wrist, made.mount.late_s);
  return made;
}

} // namespace

Result<TrackerCalibration> calibrate_tracker(const TrackerExercise& exercise) {
  const HostTime origin = exercise.poses.empty() ? HostTime{} : exercise.poses.front().measured;
  const std::vector<StationPose> poses = usable_poses(exercise.poses, origin);
  if (const auto fine = check_poses(poses, exercise.poses.size()); !fine) return fine.error();
  return exercise.on_hand ? calibrate_on_hand(exercise, poses)
                          : calibrate_on_forearm(exercise, poses, origin);
}

} // namespace nendo::hand
