#pragma once
// The values of a puppet's functions over time. They follow from hands and events alone, so that
// the model is not needed.

#include <array>
#include <functional>
#include <optional>
#include <span>

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

/// The hands and the functions at one moment.
struct PuppetMoment {
  const PuppetHands& hands;
  bool is_held = false; ///< the hands hold the model
};

/// Calls `see` with the number of each time and the functions as they are then. At the time of a
/// frame they are those of Player, unless the hands cannot grab the model there. Times must
/// not fall. The timeline must have a puppet and be playable (complaint_about()).
void play_functions(const Timeline& timeline, std::span<const double> times_s,
                    const std::function<void(std::size_t, const PuppetMoment&)>& see);

} // namespace nendo::timeline
