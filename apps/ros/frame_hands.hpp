#pragma once
// The hands of a loop's frame, for HandMessages. Users of this header link nendo::flow.

#include <array>
#include <span>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/hand/angle_sources.hpp>

#include "ros/hand_messages.hpp"

namespace nendo::ros {

inline StagePose stage_pose(const Eigen::Isometry3d& pose) noexcept {
  return {pose.translation(), Eigen::Quaterniond(pose.linear())};
}

/// Returns the state of a hand that is present. A hand without sensors is that of a timeline, whose
/// keys define all angles, as if they were measured. Wait-free.
inline HandState state_of(Side side, const flow::HandFrame& hand) noexcept {
  HandState state;
  state.side = side;
  for (std::size_t at = 0; at < hand::joint_count; ++at)
    state.joints[at] = stage_pose(hand.pose.joints[at]);
  state.forearm = stage_pose(hand.T_stage_wrist);
  state.measured = hand.sensors == SensorMask{}
                       ? (1U << hand::angle_count) - 1
                       : hand::measured_bits(hand::angle_sources(hand.sensors, hand.left_out));
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    state.angles_rad[at] = hand.angles[hand::angle_at(at)];
  return state;
}

/// The hands that are present in a frame, the left one first.
class FrameHands {
public:
  FrameHands() = default;
  explicit FrameHands(const flow::Frame& frame) noexcept {
    for (const Side side : {Side::left, Side::right}) {
      const flow::HandFrame& hand = frame.hands[flow::Placement::index_of(side)];
      if (hand.present) hands_[count_++] = state_of(side, hand);
    }
  }
  std::span<const HandState> all() const noexcept { return {hands_.data(), count_}; }

private:
  std::array<HandState, 2> hands_;
  std::size_t count_ = 0;
};

} // namespace nendo::ros
