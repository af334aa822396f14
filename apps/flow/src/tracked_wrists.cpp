#include "tracked_wrists.hpp"

namespace nendo::flow {

TrackedWrists::TrackedWrists(const std::vector<HandInput>& inputs,
                             const Placement& placement) noexcept {
  for (const HandInput& input : inputs) {
    auto& wrist = of(input.side);
    if (wrist || !input.wrist_source) continue;
    const auto& [ring, options] = *input.wrist_source;
    const auto& T_stage_placed = placement.T_stage_wrist[Placement::index_of(input.side)];
    wrist.emplace(Wrist{ring, options, T_stage_placed, {options, T_stage_placed}});
  }
}

hand::TrackingCounts TrackedWrists::Wrist::counts() const noexcept {
  const hand::TrackingCounts& now = tracking.counts();
  return {before.poses + now.poses, before.refused + now.refused, before.flips + now.flips,
          before.losses + now.losses};
}

bool TrackedWrists::is_on_hand(Side side) const noexcept {
  return of(side) && of(side)->options.mount.on_hand;
}

void TrackedWrists::begin_tick() noexcept {
  for (auto& wrist : wrists_)
    if (wrist) wrist->fresh = false;
}

void TrackedWrists::take(Side side, const PoseSample& pose) noexcept {
  auto& wrist = of(side);
  if (!wrist) return;
  wrist->tracking.take(pose);
  wrist->fresh = true;
}

bool TrackedWrists::advance(HostTime now, LoopStats& stats) noexcept {
  bool releases = false;
  for (std::size_t slot = 0; slot < wrists_.size(); ++slot) {
    auto& wrist = wrists_[slot];
    if (!wrist) continue;
    const bool far = wrist->tracking.advance(now);
    releases = releases || far;
    WristStats& counted = stats.wrists[slot];
    counted.tracked = true;
    counted.is_lost = wrist->tracking.is_lost();
    counted.counts = wrist->counts();
    counted.releases += far ? 1U : 0U;
  }
  return releases;
}

void TrackedWrists::recentre(Side side, const Eigen::Isometry3d& T_stage_wrist) noexcept {
  if (of(side)) of(side)->tracking.recentre(T_stage_wrist);
}

void TrackedWrists::recentre_all() noexcept {
  for (auto& wrist : wrists_)
    if (wrist) wrist->tracking.recentre(wrist->T_stage_placed);
}

void TrackedWrists::restart() noexcept {
  for (auto& wrist : wrists_) {
    if (!wrist) continue;
    wrist->before = wrist->counts();
    wrist->T_stage_placed = wrist->tracking.T_stage_wrist();
    wrist->tracking = hand::WristTracking(wrist->options, wrist->T_stage_placed);
  }
}

void TrackedWrists::show(Side side, HandFrame& frame) const noexcept {
  const auto& wrist = of(side);
  frame.tracked = wrist.has_value();
  if (!wrist) return;
  frame.lost = wrist->tracking.is_lost();
  frame.pose_counts = wrist->counts();
  frame.newest_pose = wrist->tracking.latest().arrival;
  frame.tracked_at = wrist->tracking.latest().measured;
}

void TrackedWrists::record_latencies(HostTime done, LoopStats& stats) const noexcept {
  for (const auto& wrist : wrists_) {
    if (!wrist || !wrist->fresh) continue;
    const PoseSample& latest = wrist->tracking.latest();
    stats.pose_to_frame.record(done - latest.arrival);
    stats.pose_age.record(done - latest.measured +
                          from_seconds(wrist->options.mount.late_s)); // by which it lies behind
  }
}

} // namespace nendo::flow
