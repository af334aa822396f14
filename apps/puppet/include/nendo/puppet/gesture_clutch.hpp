#pragma once
// Gestures by which a hand releases a puppet and grabs it again: a fist or a pinch, held for a
// moment. During a gesture, the functions return to their values before it, so that the gesture
// itself does not move the puppet.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/base/units.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::puppet {

/// Returns the strength of a gesture: for a fist the smallest bend of the four fingers, in radians;
/// for a pinch the negative distance of the tips, in metres; for no gesture 0. Wait-free; no
/// allocation.
NENDO_API double gesture_strength(ClutchTrigger means, const HandState& hand) noexcept;

/// Watches both hands of a player. For one thread; only the constructor allocates. The result
/// depends only on poses and times, so a replay of the same ticks is identical.
///
/// A gesture begins when its strength reaches the puppet's threshold, and ends below a lower one.
/// During it, the functions return, within ease_s, to their values before the hand closed. If it
/// lasts for ClutchOptions::held_s, the hand releases. A hand that had released grabs again when
/// the gesture has ended and the fingers are at rest, so that opening the hand moves nothing
/// either. After a shorter gesture, the functions return to the hand's values within ease_s.
class NENDO_API GestureClutch {
public:
  static constexpr double ease_s = 0.2;       ///< less than any held_s
  static constexpr double look_back_s = 0.6;  ///< max duration of closing a hand
  static constexpr double rest_s = 0.15;      ///< min duration without motion of fingers at rest
  static constexpr double max_rest_s = 1.0;   ///< fingers are assumed to be at rest after this time
  static constexpr double fist_ends_at = 0.8; ///< fraction of the fist threshold
  static constexpr double pinch_ends_at = 1.5; ///< fraction of the pinch threshold

  explicit GestureClutch(const Rig& rig);

  /// Processes the hands. Call before RigPlayer::follow(), with times that do not decrease. An
  /// absent hand keeps its state.
  void watch(RigPlayer& player, const RigPlayer::Hands& hands, HostTime time) noexcept;
  /// Resets the state. A gesture in progress has no effect.
  void reset(RigPlayer& player) noexcept;

private:
  enum class State : std::uint8_t {
    unknown, ///< no pose seen yet
    open,    ///< no gesture
    made,    ///< a gesture, not long enough yet
    done,    ///< a gesture that has had its effect
    taking,  ///< a gesture, at whose end the hand grabs
    opening, ///< the end of the gesture in `taking`
  };
  struct Moment {
    HostTime time{};
    double strength = 0.0;
    bool followed = false;     ///< the functions followed the hand
    std::vector<double> asked; ///< requested values, one per function
  };
  struct Watch {
    State state = State::unknown;
    HostTime since{};  ///< beginning of the state
    HostTime last{};   ///< last time of a pose
    double ramp = 0.0; ///< 0: the hand is followed; 1: the functions are kept
    std::vector<double> kept;
    std::array<Moment, 32> moments{}; ///< ring buffer of the latest moments
    std::size_t count = 0;            ///< number of moments so far

    void go_to(State next) noexcept {
      state = next;
      since = last;
    }
    double lasted_s() const noexcept { return to_seconds(last - since); }
    void look_back(const RigPlayer& player, double strength) noexcept;
    void note(const RigPlayer& player, double strength, bool followed) noexcept;
    /// Calls `visit` for each moment since `oldest`, the newest first.
    template <class Visit>
    void each_since(HostTime oldest, const Visit& visit) const noexcept {
      for (std::size_t back = 1; back <= std::min(count, moments.size()); ++back) {
        const Moment& moment = moments[(count - back) % moments.size()];
        if (moment.time < oldest) return;
        visit(moment);
      }
    }
  };
  void look(RigPlayer& player, Side side, const RigPlayer::Hands& hands, HostTime time) noexcept;
  void advance(Watch& watch, RigPlayer& player, Side side, const RigPlayer::Hands& hands,
               double strength) noexcept;
  bool rests(const Watch& watch, ClutchTrigger means, double strength) const noexcept;
  double bound(ClutchTrigger means) const noexcept;

  ClutchOptions options_;
  std::array<Watch, 2> watches_; ///< indexed by side
};

} // namespace nendo::puppet
