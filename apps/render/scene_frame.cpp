#include "render/scene_frame.hpp"

namespace nendo::render {

void HoldTracker::follow(const flow::Frame& frame) noexcept {
  if (!watch_.follow(frame)) return;
  for (std::size_t slot = 0; slot < starts_.size(); ++slot)
    starts_[slot] = frame.hands[slot].pose.fingertip_positions();
}

void set_hands(const flow::Frame& frame, const HoldTracker& holds, SceneFrame& scene_frame) {
  const bool is_puppet = frame.function_count > 0; // which fingertips do not touch
  const bool is_by_hands = frame.clay.is_clay || frame.parts.count > 0; // whose tips hold nothing
  scene_frame.held = frame.held && !is_puppet && !is_by_hands;
  scene_frame.contacts.clear();
  for (const deform::ClayContact& contact : frame.contacts.all())
    scene_frame.contacts.push_back(
        {contact.place / frame.units_per_metre, flow::strength_of(contact)});
  scene_frame.wire.clear();
  if (frame.wire.is_drawing())
    for (const deform::WirePlace& place : frame.wire.places())
      scene_frame.wire.push_back(
          {place.from / frame.units_per_metre, place.to / frame.units_per_metre});
  for (std::size_t slot = 0; slot < scene_frame.hands.size(); ++slot) {
    const flow::HandFrame& hand = frame.hands[slot];
    scene_frame.hands[slot].reset();
    if (!hand.present) continue;
    scene_frame.hands[slot] = SceneHand{
        hand.pose, frame.held ? holds.starts(slot) : hand.pose.fingertip_positions(), hand.silent};
  }
}

} // namespace nendo::render
