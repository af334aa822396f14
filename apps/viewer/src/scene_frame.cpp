#include <nendo/viewer/scene_frame.hpp>

#include <algorithm>

namespace nendo::viewer {

void HoldFollower::follow(const flow::Frame& frame) noexcept {
  if (!watch_.follow(frame)) return;
  for (std::size_t slot = 0; slot < starts_.size(); ++slot)
    starts_[slot] = frame.hands[slot].pose.fingertip_positions();
}

void see_hands(const flow::Frame& frame, const HoldFollower& holds, SceneFrame& moment) {
  moment.held = frame.held;
  for (std::size_t slot = 0; slot < moment.hands.size(); ++slot) {
    const flow::HandFrame& hand = frame.hands[slot];
    moment.hands[slot].reset();
    if (!hand.present) continue;
    moment.hands[slot] = SeenHand{
        hand.pose, frame.held ? holds.starts(slot) : hand.pose.fingertip_positions(), hand.silent};
  }
}

std::array<double, 5> radii_on_stage(const deform::Supports& supports, double units_per_metre) {
  std::array<double, 5> radii{};
  for (const auto& own : supports.own) {
    auto& radius = radii[static_cast<std::size_t>(own.point) % radii.size()];
    radius = std::max(radius, own.support.radius / units_per_metre);
  }
  if (!supports.own.empty()) return radii; // the shared one then but joins them
  for (const auto& shared : supports.shared)
    for (auto& radius : radii)
      radius = std::max(radius, shared.radius / units_per_metre);
  return radii;
}

} // namespace nendo::viewer
