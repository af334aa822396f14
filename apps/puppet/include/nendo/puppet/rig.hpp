#pragma once
// A puppet on its model, and the hands that play it: from the hands' signals to the places of the
// points. A function's value is linear in its signal, and the points are linear in the values, so
// that a puppet of Type-1 is a sum of shapes (blend shapes), one for each function.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include <nendo/deform/supports.hpp>
#include <nendo/puppet/puppet.hpp>

namespace nendo::puppet {

/// What the functions do on one model. It does not change.
class Rig {
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
  deform::Supports supports() const; ///< a radius for each point, for distances through the air

private:
  void place_vectors();

  Puppet puppet_;
  deform::Points starts_;
  std::vector<deform::Points> vectors_; ///< of each function
};

/// Plays a rig. For one thread; the functions neither allocate nor wait, but for the constructor.
class RigPlayer {
public:
  using Hands = std::array<const HandState*, 2>; ///< left and right; null: not there

  explicit RigPlayer(std::shared_ptr<const Rig> rig);

  /// Lets all functions take hold of the hands as they are, at the values that they have: relaxed
  /// hands then leave the model as it is.
  void take_hold(const Hands& hands) noexcept;
  /// Follows the hands. Functions whose hand is not there keep their values.
  void follow(const Hands& hands) noexcept;
  /// Writes where the points are, 3 by #points, model units.
  void write(deform::Points& points) const noexcept;

  const Rig& rig() const noexcept { return *rig_; }
  /// Returns the value of each function.
  std::span<const double> values() const noexcept { return values_; }
  /// Returns what the hands ask of each function, before its limits: what another player needs to
  /// go on from here.
  std::span<const double> asked() const noexcept { return asked_; }
  /// Sets that of the first functions. Call take_hold() then.
  void set_asked(std::span<const double> values) noexcept;

private:
  struct Hold {
    double signal = 0.0; ///< at which the hand took hold
    double value = 0.0;  ///< that it had asked for until then
  };

  std::shared_ptr<const Rig> rig_;
  std::vector<Hold> holds_;
  std::vector<double> asked_;
  std::vector<double> values_;
};

} // namespace nendo::puppet
