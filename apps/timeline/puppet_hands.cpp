#include "timeline/puppet_hands.hpp"

namespace nendo::timeline {

PuppetHands::PuppetHands(const Timeline& timeline) : puppet_(timeline.rig) {
  puppet_.player().set_state(timeline.rig_state);
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
  if (flow::is_for_puppet(command)) puppet_.apply(command, hands());
  if (command == flow::Command(flow::Request::take_hold)) take_hold();
}

double PuppetHands::signal(const puppet::HandSignal& input) const noexcept {
  const auto& hand = states_[static_cast<std::size_t>(input.side())];
  return hand ? input.of(*hand) : 0.0;
}

} // namespace nendo::timeline
