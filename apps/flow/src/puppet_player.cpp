#include <nendo/flow/puppet_player.hpp>

#include <algorithm>
#include <utility>

namespace nendo::flow {

PuppetPlayer::PuppetPlayer(std::shared_ptr<const puppet::Rig> rig)
    : player_(std::move(rig)), gestures_(player_.rig()), held_at_(player_.values().size()),
      still_at_(held_at_) {}

void PuppetPlayer::apply(const Command& command, const Hands& hands) noexcept {
  if (const auto* clutch = std::get_if<SetClutch>(&command))
    player_.set_clutch(clutch->side, clutch->finger, clutch->holds, hands);
  if (const auto* role = std::get_if<SetRole>(&command))
    player_.set_input(role->function, role->input, hands);
  if (const auto* symmetry = std::get_if<SetSymmetry>(&command))
    player_.set_symmetric(symmetry->on);
}

void PuppetPlayer::play(bool is_held, const Hands& hands, std::optional<HostTime> time) noexcept {
  if (is_held) {
    if (time) gestures_.watch(player_, hands, *time);
    player_.follow(hands);
  } else {
    gestures_.reset(player_);
    player_.regrab(hands);
  }
}

void PuppetPlayer::keep_held_values() noexcept {
  std::copy(player_.values().begin(), player_.values().end(), held_at_.begin());
}

void PuppetPlayer::keep_still_values() noexcept {
  std::copy(player_.values().begin(), player_.values().end(), still_at_.begin());
}

void PuppetPlayer::remember(const PuppetPlayer& earlier) {
  player_.remember(earlier.player_);
  held_at_ = earlier.held_at_;
  held_at_.resize(still_at_.size());
}

void PuppetPlayer::take_over(const PuppetPlayer* before, std::span<const std::size_t> from,
                             const Hands& hands, deform::Points& starts) noexcept {
  if (before != nullptr) {
    player_.continue_from(before->player_, from, hands);
    for (std::size_t at = 0; at < held_at_.size(); ++at)
      if (from[at] < before->held_at_.size()) held_at_[at] = before->held_at_[from[at]];
  } else {
    player_.regrab(hands);
  }
  player_.rig().place(held_at_, starts);
}

} // namespace nendo::flow
