// The part of the loop in which hands play a puppet.

#include <nendo/flow/deform_loop.hpp>

namespace nendo::flow {

void DeformLoop::set_rig(const Command& command) noexcept {
  if (const auto* clutch = std::get_if<SetClutch>(&command))
    rig_->set_clutch(clutch->side, clutch->finger, clutch->holds, hands_now());
  if (const auto* role = std::get_if<SetRole>(&command))
    rig_->set_input(role->function, role->input, hands_now());
  if (const auto* symmetry = std::get_if<SetSymmetry>(&command)) rig_->set_symmetric(symmetry->on);
}

void DeformLoop::tell_rig(Frame& frame) const noexcept {
  if (!rig_) {
    frame.let_go = {};
    frame.symmetric = mirror_.has_value();
    frame.function_count = 0;
    return;
  }
  for (const Side side : {Side::left, Side::right})
    frame.let_go[Placement::index_of(side)] = rig_->has_let_go(side);
  frame.symmetric = rig_->state().symmetric;
  frame.function_count = static_cast<std::uint32_t>(rig_->values().size());
  for (std::size_t at = 0; at < rig_->values().size(); ++at)
    frame.functions[at] = static_cast<float>(rig_->values()[at]);
}

puppet::RigPlayer::Hands DeformLoop::played_hands() const noexcept {
  puppet::RigPlayer::Hands states{};
  for (const Hand& hand : hands_)
    states[hand.slot] = &hand_states_[hand.slot];
  return states;
}

/// The same, where they are now, and not when the tick computed them.
puppet::RigPlayer::Hands DeformLoop::hands_now() noexcept {
  for (const Hand& hand : hands_)
    if (hand.is_lowest)
      hand_states_[hand.slot] = {angles_of(hand), pose_of(hand), hand.T_stage_wrist};
  return played_hands();
}

/// Hands that have let go move nothing, and take hold again where they are then, as one lifts a
/// mouse.
void DeformLoop::play_rig() noexcept {
  const auto hands = played_hands();
  if (shaping_.is_held()) {
    if (due_) gestures_->watch(*rig_, hands, *due_);
    rig_->follow(hands);
  } else {
    gestures_->reset(*rig_);
    rig_->take_hold(hands);
  }
  rig_->write(tips_);
}

} // namespace nendo::flow
