#pragma once
// The pose of a hand between its keys.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <nendo/flow/puppet_player.hpp>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// Joint angles and the wrist's place follow piecewise cubics of continuous slope that stay between
/// the keys' values (Fritsch and Carlson 1980; the slopes are the harmonic means of Fritsch and
/// Butland 1984). So no joint leaves its limits, and a joint with equal values at two keys does not
/// move between them. The wrist turns at a constant speed from key to key.
class HandCurve {
public:
  /// `keys` must fulfil the conditions of HandTrack::keys.
  explicit HandCurve(std::vector<Key> keys);

  /// Returns the pose at that time. At the time of a key it is that key, bit for bit. Before the
  /// first key it is the first one, and after the last key it is the last one. Any thread may call
  /// it.
  Key at(double time_s) const noexcept;
  const std::vector<Key>& keys() const noexcept { return keys_; }

private:
  static constexpr std::size_t channel_count = hand::angle_count + 3;
  using Channels = std::array<double, channel_count>;

  double secant(std::size_t interval, std::size_t at) const noexcept;
  double slope(std::size_t key, std::size_t at) const noexcept;

  std::vector<Key> keys_;
  std::vector<Channels> slopes_; ///< per second, at the keys
};

/// A hand of a timeline, for its poses at all times.
struct MovingHand {
  explicit MovingHand(const HandTrack& track) : skeleton(track.skeleton()), curve(track.keys) {}

  puppet::HandState at(double time_s) const noexcept;

  hand::HandSkeleton skeleton;
  HandCurve curve;
};

/// The functions of a puppet without its model. For one thread.
class PuppetHands {
public:
  /// The timeline must have a puppet.
  explicit PuppetHands(const Timeline& timeline);

  /// Poses a hand, which then is there.
  void pose(Side side, const puppet::HandState& hand);
  /// Lets the functions grab the hands as they are.
  void regrab() noexcept { puppet_.player().regrab(hands()); }
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
