#pragma once
// A puppet that hands play: its player, clutch gestures, and the function values at the grab.

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

  /// Handles a command that is_for_puppet(). `hands` are the current poses.
  void apply(const Command& command, const Hands& hands) noexcept;
  /// Updates the functions from the hands. Hands that do not hold the model move nothing, and later
  /// re-grab at their new poses, like a lifted mouse. Detects gestures if `time` is given.
  void play(bool is_held, const Hands& hands, std::optional<HostTime> time) noexcept;
  void reset_gestures() noexcept { gestures_.reset(player_); }

  /// Stores the current values as those at the grab.
  void keep_held_values() noexcept;
  /// Stores the current values as those at the stop (Shaping::is_still()).
  void keep_still_values() noexcept;
  /// Makes the values at the stop those at the grab.
  void hold_where_stopped() noexcept { held_at_ = still_at_; }

  /// Restores the state of `earlier`, which played this puppet before. Allocates.
  void remember(const PuppetPlayer& earlier);
  /// Continues from the state of `before` (`from`: see puppet::RigPlayer::continue_from()); null:
  /// grabs with the hands. Common functions keep their values at the grab. Writes the points at
  /// these values to `starts`.
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
