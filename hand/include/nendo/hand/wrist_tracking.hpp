#pragma once
// From the poses of a tracker's station to the pose of a wrist on the stage: gate, filter, mount,
// loss and return. Uses no clock and no I/O, so a replay of the same poses gives the same bits.

#include <chrono>
#include <cstdint>

#include <Eigen/Geometry>

#include <nendo/base/units.hpp>
#include <nendo/driver/pose_sample.hpp>
#include <nendo/hand/pose_filter.hpp>
#include <nendo/hand/pose_gate.hpp>

namespace nendo::hand {

/// How a station is fastened to an arm, and how the tracker's axes lie on the stage:
/// T_stage_wrist = T_stage_tracker * T_tracker_station * T_station_wrist.
struct WristMount {
  /// The turn of T_stage_tracker, but for a turn about the vertical, which WristTracking chooses
  /// with the position when tracking begins.
  Eigen::Quaterniond stage_from_tracker = Eigen::Quaterniond::Identity();
  /// The wrist's pose in the station's frame. The wrist is the forearm's end, as for HandSkeleton.
  Eigen::Isometry3d T_station_wrist = Eigen::Isometry3d::Identity();
  /// The station is on the back of the hand, not on the forearm: the wrist's joints count as
  /// straight, since the station has their turn already.
  bool on_hand = false;
  /// How much later than the glove's samples the tracker's poses arrive, in seconds.
  double late_s = 0.0;
};

/// Returns a mount for a station whose axes agree with the tracker's while the forearm points away
/// from the operator with the palm down, and that is at the wrist.
NENDO_API WristMount usual_mount(const Eigen::Quaterniond& stage_from_tracker) noexcept;

struct TrackingOptions {
  WristMount mount{};
  PoseGateOptions gate{};
  PoseFilterOptions filter{};
  /// Multiplies the wrist's movements on the stage, about the point of the last recentring.
  double movement_scale = 1.0;
  /// The wrist freezes this time after the arrival of the last good pose.
  HostClock::duration lost_after = std::chrono::milliseconds(100);
};

struct TrackingCounts {
  std::uint64_t poses = 0;   ///< taken
  std::uint64_t refused = 0; ///< poses that the gate refused
  std::uint64_t flips = 0;   ///< poses of the wrong hemisphere, which were mirrored back
  std::uint64_t losses = 0;
};

/// The wrist that a station moves. Loop's thread; wait-free, no function allocates.
class NENDO_API WristTracking {
public:
  /// The time in which the hand goes to the measured pose after a loss. It takes more time if a
  /// fingertip would else get faster by more than max_return_speed_m_s.
  static constexpr std::chrono::milliseconds return_time{100};
  /// What the return may add to the speed of the hand's own movement.
  static constexpr double max_return_speed_m_s = 2.0;
  /// After a loss, a hand that is farther away must release the model first: the jump would tear a
  /// stroke.
  static constexpr double max_return_m = 0.2;

  /// `T_stage_wrist` is where the wrist is until the first good pose, which chooses
  /// T_stage_tracker so that the wrist stays there, as recentre() does. From the initial pitch and
  /// roll, the wrist goes to the measured ones as after a loss.
  WristTracking(const TrackingOptions& options, const Eigen::Isometry3d& T_stage_wrist) noexcept;

  /// Takes the station's next sample. The wrist moves at the next advance().
  void take(const PoseSample& sample) noexcept;
  /// Advances to the time of a tick. Returns true if the hand must release the model, because it
  /// came back farther away than max_return_m, or the gate gave in to a pose that far away.
  bool advance(HostTime now) noexcept;
  /// Chooses T_stage_tracker so that the wrist is at this position with this heading, at once. Its
  /// pitch and roll stay as measured, so vertical stays vertical. The heading is the direction of
  /// the forearm, seen from above; of a steep forearm, that of the back of the hand.
  void recentre(const Eigen::Isometry3d& T_stage_wrist) noexcept;

  const Eigen::Isometry3d& T_stage_wrist() const noexcept { return T_stage_wrist_; }
  /// Returns whether there was no good pose for `lost_after`, or none yet. The wrist is frozen.
  bool is_lost() const noexcept { return is_lost_; }
  /// Returns the last good pose, as the gate passed it: unfiltered.
  const PoseSample& latest() const noexcept { return latest_; }
  const TrackingCounts& counts() const noexcept { return counts_; }
  PoseLatency filter_latency() const noexcept { return filter_.latency(); }

private:
  /// The way from where the wrist froze to the measured pose.
  struct Return {
    Eigen::Vector3d offset_m = Eigen::Vector3d::Zero(); ///< at its begin, from the measured pose
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    HostTime begin{};
    double length_s = 0.0; ///< 0: none
  };
  Eigen::Isometry3d measured() const noexcept;
  Eigen::Isometry3d returning(const Eigen::Isometry3d& measured, HostTime now) noexcept;
  void begin_return(const Eigen::Isometry3d& measured, HostTime now) noexcept;
  void choose_stage(const Eigen::Isometry3d& T_stage_wrist) noexcept;

  TrackingOptions options_;
  PoseGate gate_;
  PoseFilter filter_;
  Eigen::Isometry3d T_stage_wrist_;
  /// The wrist's filtered pose in the tracker's frame.
  Eigen::Vector3d wrist_position_m_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond wrist_turn_ = Eigen::Quaterniond::Identity();
  /// T_stage_tracker: this turn, and the point of the tracker's frame that is at that of the stage.
  Eigen::Quaterniond stage_from_tracker_;
  Eigen::Vector3d centre_tracker_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre_stage_m_ = Eigen::Vector3d::Zero();
  Return return_;
  PoseSample latest_;
  TrackingCounts counts_;
  bool has_pose_ = false;
  bool has_jumped_ = false; ///< the gate gave in to a pose elsewhere since the last advance()
  bool is_lost_ = true;
};

} // namespace nendo::hand
