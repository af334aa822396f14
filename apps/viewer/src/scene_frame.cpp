#include <nendo/viewer/scene_frame.hpp>

namespace nendo::viewer {

void HoldTracker::follow(const flow::Frame& frame) noexcept {
  if (!watch_.follow(frame)) return;
  for (std::size_t slot = 0; slot < starts_.size(); ++slot)
    starts_[slot] = frame.hands[slot].pose.fingertip_positions();
}

void set_hands(const flow::Frame& frame, const HoldTracker& holds, SceneFrame& moment) {
  moment.held = frame.held;
  for (std::size_t slot = 0; slot < moment.hands.size(); ++slot) {
    const flow::HandFrame& hand = frame.hands[slot];
    moment.hands[slot].reset();
    if (!hand.present) continue;
    moment.hands[slot] = SceneHand{
        hand.pose, frame.held ? holds.starts(slot) : hand.pose.fingertip_positions(), hand.silent};
  }
}

} // namespace nendo::viewer
