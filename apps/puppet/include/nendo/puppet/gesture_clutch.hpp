#pragma once
// Gestures by which a hand releases a puppet, and grabs it again: a fist, or a pinch,
// that is held for a moment. While a gesture is made, the functions go back to where they were
// before it, so that the gesture itself does not play the puppet.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/base/units.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::puppet {

/// Returns how much of that gesture a hand shows: for a fist the least angle, in radians, by which
/// one of four fingers is bent; for a pinch how near the tips are, in metres, negative. No gesture
/// has 0. Wait-free; no allocation.
NENDO_API double gesture_strength(ClutchTrigger means, const HandState& hand) noexcept;

/// Watches both hands of a player. For one thread; only the constructor allocates. It depends on
/// poses and times alone, so a replay of the same ticks does the same.
///
/// A gesture begins where its strength reaches the bound of the puppet, and ends below a lower one.
/// From its beginning on, the functions are drawn to the values that they had before the hand
/// closed, within ease_s. If it lasts for ClutchOptions::held_s, the hand releases. A hand that had
/// release re-grabs when the gesture has ended and the fingers have come to rest, so that
/// opening the hand plays nothing either. If a gesture is shorter, the functions go back to what
/// the hand shows, within ease_s.
class NENDO_API GestureClutch {
public:
  static constexpr double ease_s = 0.2;        ///< less than any held_s
  static constexpr double look_back_s = 0.6;   ///< closing a hand may take so long
  static constexpr double rest_s = 0.15;       ///< fingers at rest hardly move for so long
  static constexpr double max_rest_s = 1.0;    ///< after which they are taken to be at rest
  static constexpr double fist_ends_at = 0.8;  ///< fraction of its bound
  static constexpr double pinch_ends_at = 1.5; ///< fraction of its bound

  explicit GestureClutch(const Rig& rig);

  /// Looks at the hands, before RigPlayer::follow() does so, at a time that does not go back. A
  /// hand that is not there stays in the state that it had.
  void watch(RigPlayer& player, const RigPlayer::Hands& hands, HostTime time) noexcept;
  /// Forgets what was before. A gesture that is made just then has no effect.
  void reset(RigPlayer& player) noexcept;

private:
  enum class State : std::uint8_t {
    unknown, ///< nothing was seen yet
    open,    ///< no gesture
    made,    ///< a gesture, not long enough yet
    done,    ///< a gesture that has had its effect
    taking,  ///< a gesture, behind whose end the hand grabs
    opening, ///< its end
  };
  struct Moment {
    HostTime time{};
    double strength = 0.0;
    bool followed = false;     ///< the functions did what the hand showed
    std::vector<double> asked; ///< one per function
  };
  struct Watch {
    State state = State::unknown;
    HostTime since{};  ///< begin of the state
    HostTime last{};   ///< seen
    double ramp = 0.0; ///< 0: the hand is followed; 1: the functions are kept
    std::vector<double> kept;
    std::array<Moment, 32> moments{}; ///< a ring of the last ones
    std::size_t count = 0;            ///< number of moments so far

    void go_to(State next) noexcept {
      state = next;
      since = last;
    }
    double lasted_s() const noexcept { return to_seconds(last - since); }
    void look_back(const RigPlayer& player, double strength) noexcept;
    void note(const RigPlayer& player, double strength, bool followed) noexcept;
    /// Calls that for each moment that is not older, the newest first.
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
