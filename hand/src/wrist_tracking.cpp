#include <nendo/hand/wrist_tracking.hpp>

#include <algorithm>
#include <cmath>

namespace nendo::hand {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// From the wrist to the farthest fingertip of a large hand.
constexpr double reach_m = 0.25;

/// Returns the direction in which a wrist points, seen from above: x and z of the stage, unit
/// length.
Vector2d heading_of(const Matrix3d& turn) noexcept {
  constexpr double steepest = 0.5; // the cosine of the slope: 60 degrees
  const Vector3d ahead = -turn.col(2);
  const Vector2d level(ahead.x(), ahead.z());
  if (level.norm() > steepest) return level.normalized();
  // The back of the hand is ahead of a forearm that points down, and behind one that points up.
  const Vector3d back = turn.col(1);
  return Vector2d(back.x(), back.z()).normalized() * (ahead.y() < 0.0 ? 1.0 : -1.0);
}

/// Returns the turn about the vertical from one heading to another.
Quaterniond turn_between(const Vector2d& from, const Vector2d& to) noexcept {
  // The angle counts from z to x, as a turn about y does.
  const double cosine = from.dot(to);
  const double sine = from.y() * to.x() - from.x() * to.y();
  const Vector2d half(1.0 + cosine, sine);
  if (half.norm() < 1e-9) return {0.0, 0.0, 1.0, 0.0}; // w x y z: half a turn
  return Quaterniond(half.x(), 0.0, half.y(), 0.0).normalized();
}

Isometry3d isometry_of(const Vector3d& position_m, const Quaterniond& turn) noexcept {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = turn.toRotationMatrix();
  pose.translation() = position_m;
  return pose;
}

/// A smooth step from 0 to 1, which is 1.5 times as fast in the middle as on average.
double eased(double part) noexcept {
  return part * part * (3.0 - 2.0 * part);
}
constexpr double eased_peak = 1.5;

/// Returns the sample with the wrist's pose in place of the station's.
PoseSample at_wrist(const PoseSample& sample, const Isometry3d& T_station_wrist) noexcept {
  const Quaterniond turn(sample.turn_xyzw.data());
  PoseSample wrist = sample;
  Vector3d::Map(wrist.position_m.data()) += turn * T_station_wrist.translation();
  Eigen::Vector4d::Map(wrist.turn_xyzw.data()) =
      (turn * Quaterniond(T_station_wrist.linear())).normalized().coeffs();
  return wrist;
}

} // namespace

WristMount usual_mount(const Quaterniond& stage_from_tracker) noexcept {
  WristMount mount;
  mount.stage_from_tracker = stage_from_tracker.normalized();
  // A hand that points away from the operator with the palm down has the axes of the stage.
  mount.T_station_wrist.linear() = mount.stage_from_tracker.conjugate().toRotationMatrix();
  return mount;
}

WristTracking::WristTracking(const TrackingOptions& options,
                             const Isometry3d& T_stage_wrist) noexcept
    : options_(options), gate_(options.gate), filter_(options.filter),
      T_stage_wrist_(T_stage_wrist),
      stage_from_tracker_(options.mount.stage_from_tracker.normalized()) {}

Isometry3d WristTracking::measured() const noexcept {
  const Vector3d moved_m = stage_from_tracker_ * (wrist_position_m_ - centre_tracker_m_);
  return isometry_of(centre_stage_m_ + options_.movement_scale * moved_m,
                     (stage_from_tracker_ * wrist_turn_).normalized());
}

void WristTracking::choose_stage(const Isometry3d& T_stage_wrist) noexcept {
  const Quaterniond level = options_.mount.stage_from_tracker.normalized();
  const Matrix3d turn = (level * wrist_turn_).toRotationMatrix();
  stage_from_tracker_ =
      (turn_between(heading_of(turn), heading_of(T_stage_wrist.linear())) * level).normalized();
  centre_tracker_m_ = wrist_position_m_;
  centre_stage_m_ = T_stage_wrist.translation();
}

void WristTracking::take(const PoseSample& sample) noexcept {
  ++counts_.poses;
  const auto passed = gate_.pass(sample);
  counts_.refused = gate_.refused();
  counts_.flips = gate_.flips();
  if (!passed) return;
  latest_ = *passed;
  has_jumped_ = has_jumped_ || gate_.has_restarted();
  // The wrist's pose is filtered and not the station's, which also moves if the forearm only turns
  // about the wrist: the lags of its position and of its turn would differ.
  const PoseSample filtered = filter_.pass(at_wrist(*passed, options_.mount.T_station_wrist));
  wrist_position_m_ = Vector3d::Map(filtered.position_m.data());
  wrist_turn_ = Quaterniond(filtered.turn_xyzw.data());
  if (!has_pose_) choose_stage(T_stage_wrist_);
  has_pose_ = true;
}

// The offset from the measured pose shrinks while the hand's own movement continues.
void WristTracking::begin_return(const Isometry3d& measured, HostTime now) noexcept {
  return_.offset_m = T_stage_wrist_.translation() - measured.translation();
  return_.turn = Quaterniond(T_stage_wrist_.linear() * measured.linear().transpose()).normalized();
  return_.begin = now;
  const double farthest_m =
      return_.offset_m.norm() + reach_m * return_.turn.angularDistance(Quaterniond::Identity());
  return_.length_s =
      std::max(to_seconds(return_time), eased_peak * farthest_m / max_return_speed_m_s);
}

Isometry3d WristTracking::returning(const Isometry3d& measured, HostTime now) noexcept {
  const double since_s = std::max(seconds_between(return_.begin, now), 0.0);
  if (!(since_s < return_.length_s)) {
    return_.length_s = 0.0;
    return measured;
  }
  const double left = 1.0 - eased(since_s / return_.length_s);
  const Quaterniond turn = Quaterniond::Identity().slerp(left, return_.turn);
  return isometry_of(measured.translation() + left * return_.offset_m,
                     (turn * Quaterniond(measured.linear())).normalized());
}

bool WristTracking::advance(HostTime now) noexcept {
  if (!has_pose_) return false;
  if (seconds_between(latest_.arrival, now) > to_seconds(options_.lost_after)) {
    if (!is_lost_) ++counts_.losses;
    is_lost_ = true;
    return false;
  }
  const Isometry3d T_stage_measured = measured();
  bool must_release = false;
  if (is_lost_ || has_jumped_) {
    is_lost_ = has_jumped_ = false;
    begin_return(T_stage_measured, now);
    must_release = return_.offset_m.norm() > max_return_m;
  }
  T_stage_wrist_ = returning(T_stage_measured, now);
  return must_release;
}

void WristTracking::recentre(const Isometry3d& T_stage_wrist) noexcept {
  return_.length_s = 0.0;
  has_jumped_ = false;
  if (has_pose_) choose_stage(T_stage_wrist);
  T_stage_wrist_ = has_pose_ ? measured() : T_stage_wrist;
}

} // namespace nendo::hand
