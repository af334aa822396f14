#pragma once
// What the fingers of a touching hand do when: strokes into the surface and out of it, and glides
// along it between them. Parts of what a hand can do, not lengths: those are its own.

#include <array>
#include <cstdint>
#include <vector>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/joints.hpp>

namespace nendo::flow {

/// From 0 to 1, at rest at both ends; 0 before, 1 after. Arm and hand movements from rest to rest
/// have the least jerk that their ends allow (Flash and Hogan 1985), which makes them a polynomial
/// of time.
double least_jerk(double part) noexcept;

/// Goes from 0 to `depth`, stays, and comes back.
struct TouchStroke {
  double begin_s, rise_s, hold_s, fall_s;
  double depth; ///< 1: as deep in as the finger presses; -1: as far out as it pulls

  double end_s() const noexcept { return begin_s + rise_s + hold_s + fall_s; }
  /// The middle of the time in which it stays.
  double apex_s() const noexcept { return begin_s + rise_s + 0.5 * hold_s; }
};

/// Along the finger's way, which runs from 0 to 1.
struct TouchGlide {
  double begin_s, length_s;
  double from, to;
};

/// A cycle: everything begins and ends at rest on the surface at the way's beginning. Fingers press
/// or pull only while none glides.
class TouchScore {
public:
  /// The same seed gives the same score, another one another; two sides are not in lock-step.
  TouchScore(Side side, std::uint32_t seed);

  double period_s() const noexcept { return period_s_; }
  /// Any time; twice continuously differentiable, as are hands' own movements.
  double depth(hand::Finger finger, double time_s) const noexcept;
  double way(double time_s) const noexcept;
  /// In these the fingers go farthest.
  std::vector<double> extremes_s() const;

private:
  using Strokes = std::vector<TouchStroke>;

  std::array<Strokes, hand::finger_count> strokes_;
  std::vector<TouchGlide> glides_;
  double period_s_ = 0.0;
};

} // namespace nendo::flow
