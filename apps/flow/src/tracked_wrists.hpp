#pragma once
// The wrists that trackers move.

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/side.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/pose_sample.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/hand/wrist_tracking.hpp>

namespace nendo::flow {

/// Loop's thread. Only the constructor allocates.
class TrackedWrists {
public:
  TrackedWrists(const std::vector<HandInput>& inputs, const Placement& placement) noexcept;

  bool has(Side side) const noexcept { return bool(of(side)); }
  /// Returns whether the wrist's joints count as straight (hand::WristMount::on_hand).
  bool is_on_hand(Side side) const noexcept;
  const Eigen::Isometry3d& T_stage_wrist(Side side) const noexcept {
    return of(side)->tracking.T_stage_wrist();
  }

  void begin_tick() noexcept;
  /// Passes the poses that arrived since the last tick to `log(side, pose)`, and takes them.
  template <class Log>
  void drain(Log&& log) noexcept {
    for (const Side side : {Side::left, Side::right}) {
      auto& wrist = of(side);
      if (!wrist || wrist->ring == nullptr) continue;
      wrist->ring->drain([&](const PoseSample& pose) noexcept {
        log(side, pose);
        take(side, pose);
      });
    }
  }
  void take(Side side, const PoseSample& pose) noexcept;
  /// Advances to the time of a tick. Returns true if a hand must release the model, since it came
  /// back far away.
  bool advance(HostTime now, LoopStats& stats) noexcept;
  /// Puts a wrist to this position and heading.
  void recentre(Side side, const Eigen::Isometry3d& T_stage_wrist) noexcept;
  /// Puts all wrists to where the hands were placed.
  void recentre_all() noexcept;
  /// Begins as a loop that is made of the present state, with the wrists where they are.
  void restart() noexcept;

  void show(Side side, HandFrame& frame) const noexcept;
  /// Adds the ages of this tick's poses.
  void record_latencies(HostTime done, LoopStats& stats) const noexcept;

private:
  struct Wrist {
    PoseRing* ring;
    hand::TrackingOptions options;
    Eigen::Isometry3d T_stage_placed;
    hand::WristTracking tracking;
    hand::TrackingCounts before{}; ///< the counts until the last restart()
    bool fresh = false;            ///< it got poses in this tick

    hand::TrackingCounts counts() const noexcept;
  };
  std::optional<Wrist>& of(Side side) noexcept { return wrists_[Placement::index_of(side)]; }
  const std::optional<Wrist>& of(Side side) const noexcept {
    return wrists_[Placement::index_of(side)];
  }

  std::array<std::optional<Wrist>, 2> wrists_; ///< in the order of Side
};

} // namespace nendo::flow
