#pragma once
// Finds how a tracker's station is fastened to a forearm, and how late the tracker is, from ten
// seconds of one exercise: the hand lies flat on a table, points forward and stays there, while the
// elbow draws circles. The wrist's centre is then at rest, and the wrist's joints turn by the
// opposite angles. Pure functions: no clock, no I/O.

#include <cstddef>
#include <span>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/driver/pose_sample.hpp>
#include <nendo/hand/wrist_tracking.hpp>

namespace nendo::hand {

/// What the wearer is asked to do.
inline constexpr std::string_view forearm_exercise =
    "Lay your hand flat on the table, fingers to the front, keep it there, and draw circles with "
    "your elbow.";
/// The same for a station on the back of the hand.
inline constexpr std::string_view hand_exercise =
    "Lay your hand flat on the table, fingers to the front, and keep it still.";

/// The angles of the wrist's joints at one time, as in JointAngles.
struct WristAngles {
  HostTime time{}; ///< time of the measurement: GloveSample::time()
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;
};

/// The recorded exercise.
struct TrackerExercise {
  Side side = Side::right;
  /// The usual turn from the tracker's axes to the stage's; defines vertical and forward.
  Eigen::Quaterniond stage_from_tracker = Eigen::Quaterniond::Identity();
  bool on_hand = false; ///< the station is on the back of the hand
  /// Of one station, in the order of PoseSample::measured, about ten seconds.
  std::span<const PoseSample> poses;
  /// Of the same seconds, in order; empty if the glove does not measure its wrist.
  std::span<const WristAngles> wrist;
};

enum class TimeOffset : std::uint8_t {
  measured,
  no_wrist_angles, ///< the glove has none, or the two recordings overlap too shortly
  not_alike,       ///< the wrist's angles do not move as the tracker does
};

struct TrackerCalibrationReport {
  std::size_t poses_used = 0;
  std::size_t poses_dropped = 0; ///< not finite, too far, no rotation, or far off all others
  double residual_mm = 0.0;      ///< root mean square distance of the wrist's centre from its mean
  /// The half angle of the circular cone that determines the centre as well as this motion does in
  /// its weakest direction.
  double cone_deg = 0.0;
  double smallest_singular_value = 0.0; ///< the one of the centre's equations, per pose
  double condition = 0.0;               ///< largest singular value per smallest
  double centre_uncertainty_mm = 0.0;   ///< standard deviation of the centre's distance
  TimeOffset time_offset = TimeOffset::no_wrist_angles;
  double correlation = 0.0; ///< correlation of the turning velocities; 0: unknown
  /// Standard deviation, if measured. Even circles show the time only if the hand lies flat: with
  /// them, three degrees of roll count as 15 ms. Circles of changing speed show both.
  double late_uncertainty_ms = 0.0;
  /// How far the hand points to the left of the tracker's front, by the wrist's angles; 0 if they
  /// are not alike or not there.
  double heading_deg = 0.0;
};

struct TrackerCalibration {
  WristMount mount;
  TrackerCalibrationReport report;
};

/// Returns the mount: the centre by least squares without outliers, the turn from the flat hand,
/// and `late_s`, by which PoseSample::measured lies behind WristAngles::time (0 unless measured; at
/// most 0.4 s to either side). If the time offset cannot be measured, the wrist counts as straight
/// on average, and the hand as pointing to the tracker's front.
///
/// With `on_hand` the hand must be still; the result has the turn alone, and the wrist is where the
/// station is.
///
/// Error: bad_input, with what was wrong and what to do: too few poses, most of them refused, a
/// station that is still (or, on a hand, moves), a cone that is too small, a hand that slid, poses
/// that do not turn about one point. Allocates; takes some 20 ms.
NENDO_API Result<TrackerCalibration> calibrate_tracker(const TrackerExercise& exercise);

} // namespace nendo::hand
