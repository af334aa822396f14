#pragma once
// A puppet on its model, and the hands that play it: from the hands' signals to the places of the
// points. A function's value is linear in its signal, and the points are linear in the values, so
// that a puppet of Type-1 is a sum of shapes (blend shapes), one for each function.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/supports.hpp>
#include <nendo/puppet/puppet.hpp>

namespace nendo::puppet {

/// What the functions do on one model. It does not change.
class NENDO_API Rig {
public:
  /// The model must have a face. Allocates.
  Rig(Puppet puppet, const deform::Mesh& model);
  /// Makes it of the places of the points, 3 by #points, as they were on the model at first: on one
  /// that was subdivided, the nearest places may be others.
  Rig(Puppet puppet, deform::Points starts);

  const Puppet& puppet() const noexcept { return puppet_; }
  const deform::Points& starts() const noexcept { return starts_; } ///< 3 by #points, at rest
  /// Returns where that function moves each point at a value of 1: 3 by #points, model units.
  const deform::Points& vectors_of(std::size_t function) const noexcept {
    return vectors_[function];
  }
  /// Writes where the points are, 3 by #points, model units, where the first functions have these
  /// values and the others 0. Does not allocate if `points` has the right size.
  void place(std::span<const double> values, deform::Points& points) const;
  deform::Supports supports() const; ///< a radius for each point, for distances through the air

private:
  void place_vectors();

  Puppet puppet_;
  deform::Points starts_;
  std::vector<deform::Points> vectors_; ///< one set per function
};

/// Returns the function's value for this input, clamped to its limits.
NENDO_API double value_of(const Function& function, double asked) noexcept;
/// Returns the input with the least amount that gives the function this value, which must be within
/// its limits.
NENDO_API double asked_for(const Function& function, double value) noexcept;
/// Returns for each function of a puppet that was edited the number that it had before; no_function
/// if it is new.
inline constexpr std::size_t no_function = static_cast<std::size_t>(-1);
NENDO_API std::vector<std::size_t> functions_before(const Puppet& before, const Puppet& after);

/// What a player of a rig needs to continue where another one is.
struct FunctionState {
  double asked = 0.0; ///< the function's value by its hand, before its limits
  HandSignal input;
  bool held = true; ///< it has not been released by itself
  friend bool operator==(const FunctionState&, const FunctionState&) = default;
};
struct RigState {
  std::vector<FunctionState> functions; ///< none: as the puppet file says, at 0
  bool symmetric = false;
  std::array<bool, 2> hand_holds{true, true}; ///< left and right; false: all of it is released
  friend bool operator==(const RigState&, const RigState&) = default;
};

/// Plays a rig. For one thread; the functions neither allocate nor wait, but for the constructor.
class NENDO_API RigPlayer {
public:
  using Hands = std::array<const HandState*, 2>; ///< left and right; null: not there

  explicit RigPlayer(std::shared_ptr<const Rig> rig);

  /// Lets all functions grab the hands as they are, at the values that they have: relaxed
  /// hands then leave the model as it is.
  void take_hold(const Hands& hands) noexcept;
  /// Follows the hands. Functions whose hand is not there keep their values.
  void follow(const Hands& hands) noexcept;
  /// Writes where the points are (Rig::place()).
  void write(deform::Points& points) const noexcept { rig_->place(values_, points); }

  /// Lets a hand, or one of its fingers, release its functions, which then keep their values, or
  /// grab them again. finger: HandSignal::finger(), or all_fingers.
  static constexpr std::uint8_t all_fingers = 255;
  void set_clutch(Side side, std::uint8_t finger, bool holds, const Hands& hands) noexcept;
  /// Lets a hand release all its functions if it holds any, and otherwise grab them
  /// again, but for fingers that had released by themselves.
  void toggle_clutch(Side side, const Hands& hands) noexcept;
  /// While a gesture is made, draws what that hand asks for to `kept` (of each function, as
  /// asked()), in place of following it: by no part (0, as at first), or all the way (1). `kept`
  /// must live until the part is 0 again.
  void set_kept(Side side, double part, std::span<const double> kept) noexcept;
  /// Lets that function listen to another signal, from its present value on.
  void set_input(std::size_t function, HandSignal input, const Hands& hands) noexcept;
  /// While it is on, functions that are twins (...Left, ...Right) have the same value: that which
  /// is farther from 0. So one hand plays both sides.
  void set_symmetric(bool on) noexcept;

  const Rig& rig() const noexcept { return *rig_; }
  /// Returns the value of each function.
  std::span<const double> values() const noexcept { return values_; }
  const RigState& state() const noexcept { return state_; }
  /// Continues from that state, if it is one of as many functions. Call take_hold() then.
  void set_state(const RigState& state) noexcept;
  /// Takes over from an earlier player of the same rig what go_on_from() needs for functions that
  /// come back, as by an undo. Call it before.
  void remember(const RigPlayer& earlier);
  /// Continues where a player of another rig is. from: for each function, the number of the one
  /// that it was there (functions_before()). Their values stay, as far as their limits let them,
  /// and inputs that were chosen since stay chosen. Functions that come back (remember()) continue
  /// as if they had not been away, or, if their hand has re-grabbed meanwhile, from the values that
  /// they had; new functions begin at 0. Does not allocate.
  void go_on_from(const RigPlayer& before, std::span<const std::size_t> from,
                  const Hands& hands) noexcept;
  /// Returns whether nothing of that hand is held.
  bool has_let_go(Side side) const noexcept;
  /// Returns what was asked of that function, before its limits.
  double asked(std::size_t function) const noexcept { return state_.functions[function].asked; }

private:
  struct Kept {
    double part = 0.0;
    std::span<const double> asked{};
  };
  bool is_held(const FunctionState& state) const noexcept {
    return state.held && state_.hand_holds[static_cast<std::size_t>(state.input.side())];
  }
  struct Hold {
    double signal = 0.0; ///< at which the hand grabbed
    double value = 0.0;  ///< that it had asked for until then
  };
  void take_hold(std::size_t function, const Hands& hands) noexcept;
  void set_values() noexcept;

  std::shared_ptr<const Rig> rig_;
  std::vector<std::size_t> twins_; ///< each function's twin; itself, if it has none
  std::vector<Hold> holds_;
  std::array<std::uint32_t, 2> grips_{};              ///< number of grabs, by side
  std::optional<std::array<std::uint32_t, 2>> known_; ///< grips_ of the player it remembers
  std::array<Kept, 2> kept_{};                        ///< indexed by side
  RigState state_;
  std::vector<double> values_;
};

} // namespace nendo::puppet
