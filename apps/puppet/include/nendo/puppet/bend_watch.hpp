#pragma once
// Finds the finger that a person bends, to say which one shall move something.

#include <array>
#include <optional>

#include <nendo/hand/skeleton.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::puppet {

struct Bend {
  HandSignal input;    ///< the flexion of the finger
  double travel = 1.0; ///< in radians, for a value of 1; < 0 if it was straightened
};

/// Watches the flexions of all fingers from a moment on. For one thread; does not allocate.
class NENDO_API BendWatch {
public:
  /// Forgets what it has seen: the hands are as they shall be at rest.
  void begin() noexcept { rest_ = {}; }
  /// Returns the finger that has bent farthest since begin(), or since its hand came, if that is
  /// far enough, and clearly farther than its neighbours, which bend along. The lengths of bends
  /// are fractions of a finger's usual bend, so that thumbs count as much as others.
  std::optional<Bend> follow(const RigPlayer::Hands& hands) noexcept;

  /// The min bend of a finger, as a fraction of its usual bend.
  static constexpr double min_bend_fraction = 0.6;
  /// The min ratio of its bend to that of any other finger.
  static constexpr double dominance_ratio = 1.25;
  /// Returns how far that finger bends for a value of 1, in radians; 0 thumb to 4 little finger.
  static double usual_rad(std::size_t finger) noexcept;

private:
  std::array<std::optional<std::array<double, hand::finger_count>>, 2>
      rest_; ///< angles at rest, by side
};

} // namespace nendo::puppet
