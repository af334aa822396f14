#pragma once
// The hands of a timeline that play its puppet.

#include <array>
#include <optional>

#include <nendo/puppet/gesture_clutch.hpp>

#include "timeline/hand_curve.hpp"
#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// Does what flow::DeformLoop does with a puppet. For one thread.
class PuppetHands {
public:
  /// The timeline must have a puppet.
  explicit PuppetHands(const Timeline& timeline);

  /// Poses a hand, which then is there.
  void pose(Side side, const puppet::HandState& hand);
  /// Lets the functions take hold of the hands as they are.
  void take_hold() noexcept { player_.take_hold(hands()); }
  /// Does what the command says, if it is about a puppet.
  void apply(const flow::Command& command) noexcept;
  /// Lets the functions follow the hands, or take hold of them if these do not hold the model.
  /// Gestures are seen from the first `time` on.
  void play(bool is_held, std::optional<HostTime> time) noexcept;

  const puppet::RigPlayer& player() const noexcept { return player_; }
  double signal(const puppet::HandSignal& input) const noexcept; ///< 0 if that hand is not there

private:
  puppet::RigPlayer::Hands hands() const noexcept;

  puppet::RigPlayer player_;
  puppet::GestureClutch gestures_;
  std::array<std::optional<puppet::HandState>, 2> states_; ///< left and right
};

} // namespace nendo::timeline
