#pragma once
// The hands of a timeline that play its puppet.

#include <array>
#include <optional>

#include <nendo/flow/puppet_player.hpp>

#include "timeline/hand_curve.hpp"
#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// The functions of a puppet without its model. For one thread.
class PuppetHands {
public:
  /// The timeline must have a puppet.
  explicit PuppetHands(const Timeline& timeline);

  /// Poses a hand, which then is there.
  void pose(Side side, const puppet::HandState& hand);
  /// Lets the functions grab the hands as they are.
  void take_hold() noexcept { puppet_.player().take_hold(hands()); }
  /// Handles the command, if it is about a puppet.
  void apply(const flow::Command& command) noexcept;
  /// As flow::PuppetPlayer::play().
  void play(bool is_held, std::optional<HostTime> time) noexcept {
    puppet_.play(is_held, hands(), time);
  }

  const puppet::RigPlayer& player() const noexcept { return puppet_.player(); }
  double signal(const puppet::HandSignal& input) const noexcept; ///< 0 if that hand is not there

private:
  puppet::RigPlayer::Hands hands() const noexcept;

  flow::PuppetPlayer puppet_;
  std::array<std::optional<puppet::HandState>, 2> states_; ///< left and right
};

} // namespace nendo::timeline
