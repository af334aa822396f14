#pragma once
// A puppet on its model, and its player, which maps the hands' signals to point positions. A
// function's value is linear in its signal, and the positions are linear in the values, so a Type-1
// puppet is a sum of blend shapes, one per function.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/supports.hpp>
#include <nendo/puppet/puppet.hpp>

namespace nendo::puppet {

/// The effect of the functions on one model. Immutable.
class NENDO_API Rig {
public:
  /// The model must have a face. Allocates.
  Rig(Puppet puppet, const deform::Mesh& model);
  /// Uses the given point positions, 3 by #points, on the original model, because on a subdivided
  /// model the nearest surface positions may differ.
  Rig(Puppet puppet, deform::Points starts);

  const Puppet& puppet() const noexcept { return puppet_; }
  const deform::Points& starts() const noexcept { return starts_; } ///< 3 by #points, at rest
  /// Returns the displacement of each point by a function of value 1: 3 by #points, model units.
  const deform::Points& vectors_of(std::size_t function) const noexcept {
    return vectors_[function];
  }
  /// Writes the point positions, 3 by #points, model units, for these values of the first functions
  /// and 0 for the others. Does not allocate if `points` has the right size.
  void place(std::span<const double> values, deform::Points& points) const;
  deform::Supports supports() const; ///< one radius per point, for straight distances

private:
  void place_vectors();

  Puppet puppet_;
  deform::Points starts_;
  std::vector<deform::Points> vectors_; ///< one set per function
};

/// Returns the function's value for this input, clamped to its limits.
NENDO_API double value_of(const Function& function, double asked) noexcept;
/// Returns the input of smallest magnitude that gives this value, which must be within the
/// function's limits.
NENDO_API double asked_for(const Function& function, double value) noexcept;
/// Returns for each function of an edited puppet its previous index; no_function if it is new.
inline constexpr std::size_t no_function = static_cast<std::size_t>(-1);
NENDO_API std::vector<std::size_t> functions_before(const Puppet& before, const Puppet& after);

/// The state of a function, from which another player can continue.
struct FunctionState {
  double asked = 0.0; ///< the value requested by the hand, before clamping
  HandSignal input;
  bool held = true; ///< false: it was released individually
  friend bool operator==(const FunctionState&, const FunctionState&) = default;
};
struct RigState {
  std::vector<FunctionState> functions; ///< empty: as in the puppet file, at 0
  bool symmetric = false;
  std::array<bool, 2> hand_holds{true, true}; ///< left and right; false: all are released
  friend bool operator==(const RigState&, const RigState&) = default;
};

/// Plays a rig. For one thread; only the constructor allocates or waits.
class NENDO_API RigPlayer {
public:
  using Hands = std::array<const HandState*, 2>; ///< left and right; null: absent

  explicit RigPlayer(std::shared_ptr<const Rig> rig);

  /// Attaches all functions, at their current values, to the current hand poses: relaxed hands then
  /// do not change the model.
  void regrab(const Hands& hands) noexcept;
  /// Follows the hands. Functions of an absent hand keep their values.
  void follow(const Hands& hands) noexcept;
  /// Writes the point positions (Rig::place()).
  void write(deform::Points& points) const noexcept { rig_->place(values_, points); }

  /// Makes a hand, or one of its fingers, release its functions, which then keep their values, or
  /// grab them again. finger: HandSignal::finger(), or all_fingers.
  static constexpr std::uint8_t all_fingers = 255;
  void set_clutch(Side side, std::uint8_t finger, bool holds, const Hands& hands) noexcept;
  /// Makes a hand release all its functions if it holds any, and otherwise grab them again, except
  /// those of individually released fingers.
  void toggle_clutch(Side side, const Hands& hands) noexcept;
  /// During a gesture, blends the hand's requested values with `kept` (one per function, as
  /// asked()): `part` is 0, initially, for the hand's values, and 1 for `kept`. `kept` must be
  /// valid until `part` is 0 again.
  void set_kept(Side side, double part, std::span<const double> kept) noexcept;
  /// Assigns another input signal to a function, which keeps its current value.
  void set_input(std::size_t function, HandSignal input, const Hands& hands) noexcept;
  /// While on, twin functions (...Left, ...Right) both have the value that is farther from 0, so
  /// that one hand plays both sides.
  void set_symmetric(bool on) noexcept;

  const Rig& rig() const noexcept { return *rig_; }
  /// Returns the value of each function.
  std::span<const double> values() const noexcept { return values_; }
  const RigState& state() const noexcept { return state_; }
  /// Continues from a state with the same number of functions; ignores others. Call regrab()
  /// then.
  void set_state(const RigState& state) noexcept;
  /// Copies from an earlier player of the same rig the state that continue_from() needs for
  /// restored functions, for example after an undo. Call it before continue_from().
  void remember(const RigPlayer& earlier);
  /// Continues from a player of another rig. from: for each function, its index there
  /// (functions_before()). Values are kept within their limits, and so are inputs that were chosen
  /// since. Restored functions (remember()) continue as if never removed, or, if their hand has
  /// re-grabbed meanwhile, from their last values; new functions begin at 0. Does not allocate.
  void continue_from(const RigPlayer& before, std::span<const std::size_t> from,
                     const Hands& hands) noexcept;
  /// Returns whether all functions of a hand are released.
  bool has_released(Side side) const noexcept;
  /// Returns the requested value of a function, before clamping.
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
    double signal = 0.0; ///< signal at the grab
    double value = 0.0;  ///< requested value at the grab
  };
  void regrab(std::size_t function, const Hands& hands) noexcept;
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
