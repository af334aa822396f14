#include <string>
#include <utility>

#include "timeline/edit.hpp"

namespace nendo::timeline {
namespace {

Side other_of(Side side) noexcept {
  return side == Side::left ? Side::right : Side::left;
}

void mirror_key(Key& key, double plane_x_m) {
  key.wrist_m.x() = 2.0 * plane_x_m - key.wrist_m.x();
  // The turn seen in a mirror whose hand is mirrored: about x as before, about y and z the
  // other way.
  key.wrist_turn.y() = -key.wrist_turn.y();
  key.wrist_turn.z() = -key.wrist_turn.z();
}

std::size_t twin_number(const puppet::Puppet& puppet, std::size_t function) {
  const std::string& name = puppet.functions[function].name;
  return puppet.function_named(puppet::twin_of(name)).value_or(function);
}

/// Twins change their places, and each function listens to the other hand.
void mirror_roles(Timeline& timeline) {
  const puppet::Puppet& puppet = timeline.rig->puppet();
  const std::vector<puppet::FunctionState> before = timeline.rig_state.functions;
  for (std::size_t at = 0; at < before.size(); ++at)
    timeline.rig_state.functions[twin_number(puppet, at)] = {
        before[at].asked, before[at].input.mirrored(), before[at].held};
  for (Event& event : timeline.events) {
    if (auto* const clutch = std::get_if<flow::SetClutch>(&event.command))
      clutch->side = other_of(clutch->side);
    if (auto* const role = std::get_if<flow::SetRole>(&event.command))
      *role = {static_cast<std::uint16_t>(twin_number(puppet, role->function)),
               role->input.mirrored()};
  }
}

/// plane_x: model units.
std::shared_ptr<const puppet::Rig> mirrored_masks(const puppet::Rig& masks, double plane_x) {
  puppet::Puppet puppet = masks.puppet();
  if (puppet.mirrors) puppet.mirror_at = 2.0 * plane_x - puppet.mirror_at;
  for (puppet::Mask& mask : puppet.masks)
    mask.at.x() = 2.0 * plane_x - mask.at.x();
  puppet.text = puppet::text_of(puppet);
  return std::make_shared<const puppet::Rig>(std::move(puppet), masks.starts());
}

} // namespace

Result<void> mirror(Timeline& timeline, double plane_x_m) {
  Timeline result = timeline;
  for (HandTrack& hand : result.hands) {
    hand.side = other_of(hand.side);
    for (Key& key : hand.keys)
      mirror_key(key, plane_x_m);
  }
  for (auto& masks : result.masks)
    if (masks) masks = mirrored_masks(*masks, plane_x_m * timeline.units_per_metre);
  if (result.rig) mirror_roles(result);
  if (std::string wrong = complaint_about(result); !wrong.empty())
    return Error{Errc::usage, std::move(wrong)};
  timeline = std::move(result);
  return {};
}

} // namespace nendo::timeline
