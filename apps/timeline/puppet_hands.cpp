#include "timeline/puppet_hands.hpp"

namespace nendo::timeline {

PuppetHands::PuppetHands(const Timeline& timeline)
    : player_(timeline.rig), gestures_(*timeline.rig) {
  player_.set_state(timeline.rig_state);
}

void PuppetHands::pose(Side side, const puppet::HandState& hand) {
  states_[static_cast<std::size_t>(side)] = hand;
}

puppet::RigPlayer::Hands PuppetHands::hands() const noexcept {
  puppet::RigPlayer::Hands hands{};
  for (std::size_t side = 0; side < states_.size(); ++side)
    hands[side] = states_[side] ? &*states_[side] : nullptr;
  return hands;
}

void PuppetHands::apply(const flow::Command& command) noexcept {
  if (const auto* clutch = std::get_if<flow::SetClutch>(&command))
    player_.set_clutch(clutch->side, clutch->finger, clutch->holds, hands());
  if (const auto* role = std::get_if<flow::SetRole>(&command))
    player_.set_input(role->function, role->input, hands());
  if (const auto* symmetry = std::get_if<flow::SetSymmetry>(&command))
    player_.set_symmetric(symmetry->on);
  if (command == flow::Command(flow::Request::take_hold)) take_hold();
}

void PuppetHands::play(bool is_held, std::optional<HostTime> time) noexcept {
  if (is_held) {
    if (time) gestures_.watch(player_, hands(), *time);
    player_.follow(hands());
  } else {
    gestures_.reset(player_);
    player_.take_hold(hands());
  }
}

double PuppetHands::signal(const puppet::HandSignal& input) const noexcept {
  const auto& hand = states_[static_cast<std::size_t>(input.side())];
  return hand ? input.of(*hand) : 0.0;
}

} // namespace nendo::timeline
