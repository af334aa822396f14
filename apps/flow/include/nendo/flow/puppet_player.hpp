#pragma once
// A puppet that hands play: its player, its clutch gestures, and the values at which the hands hold
// the shape.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/base/units.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/puppet/gesture_clutch.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// Loop's thread. Only the constructor allocates.
class NENDO_API PuppetPlayer {
public:
  using Hands = puppet::RigPlayer::Hands;

  explicit PuppetPlayer(std::shared_ptr<const puppet::Rig> rig);

  /// Handles a command that is_for_puppet(). `hands` are where they are now.
  void apply(const Command& command, const Hands& hands) noexcept;
  /// Updates the functions by the hands. Hands that do not hold the model move nothing, and grab
  /// again where they are then, as one lifts a mouse. Gestures are watched if there is a time.
  void play(bool is_held, const Hands& hands, std::optional<HostTime> time) noexcept;
  void reset_gestures() noexcept { gestures_.reset(player_); }

  /// Keeps the present values as those at which the hands grabbed the shape.
  void keep_held_values() noexcept;
  /// Keeps the present values as those at which the hands stopped (Shaping::is_still()).
  void keep_still_values() noexcept;
  /// The hands hold the shape at the values at which they stopped.
  void hold_where_stopped() noexcept { held_at_ = still_at_; }

  /// Prepares this puppet, which was played before as `earlier`, to be played again. Allocates.
  void remember(const PuppetPlayer& earlier);
  /// Continues where `before` was, if it is not null (puppet::RigPlayer::go_on_from(), which says
  /// what `from` is), or grabs with the hands. Functions that both have keep the values at which
  /// the hands hold the shape; `starts` gets the points at these values.
  void take_over(const PuppetPlayer* before, std::span<const std::size_t> from, const Hands& hands,
                 deform::Points& starts) noexcept;

  puppet::RigPlayer& player() noexcept { return player_; }
  const puppet::RigPlayer& player() const noexcept { return player_; }

private:
  puppet::RigPlayer player_;
  puppet::GestureClutch gestures_;
  std::vector<double> held_at_;
  std::vector<double> still_at_;
};

} // namespace nendo::flow
