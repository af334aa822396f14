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
  double movement_scale = 1.0; ///< of the station's movements on the stage
  HostClock::duration lost_after = std::chrono::milliseconds(100);
};

struct TrackingCounts {
  std::uint64_t poses = 0;   ///< taken
  std::uint64_t refused = 0; ///< by the gate
  std::uint64_t flips = 0;   ///< poses of the wrong hemisphere, which were mirrored back
  std::uint64_t losses = 0;
};

/// The wrist that a station moves. Loop's thread; no function allocates.
class NENDO_API WristTracking {
public:
  /// The time in which the hand goes to the measured pose after a loss.
  static constexpr std::chrono::milliseconds return_time{100};
  /// After a loss, a hand that is farther away must release the model first: the jump would tear a
  /// stroke.
  static constexpr double max_return_m = 0.2;

  /// `T_stage_wrist` is where the wrist is until the first good pose, and then, too: that pose
  /// chooses T_stage_tracker, as recentre() does.
  WristTracking(const TrackingOptions& options, const Eigen::Isometry3d& T_stage_wrist) noexcept;

  void take(const PoseSample& sample) noexcept;
  /// Advances to the time of a tick. Returns true if the hand must release the model, because it
  /// came back farther away than max_return_m.
  bool advance(HostTime now) noexcept;
  /// Chooses T_stage_tracker so that the wrist is at this position with this heading. Its pitch and
  /// roll stay as measured, so vertical stays vertical.
  void recentre(const Eigen::Isometry3d& T_stage_wrist) noexcept;

  const Eigen::Isometry3d& T_stage_wrist() const noexcept;
  bool is_lost() const noexcept; ///< no good pose for `lost_after`; the wrist is frozen
  const PoseSample& latest() const noexcept; ///< the last good pose, unfiltered
  const TrackingCounts& counts() const noexcept;
};

} // namespace nendo::hand
