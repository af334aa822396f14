#pragma once
// The time plan of a touching hand's fingers: strokes into the surface and out of it, and glides
// along it between them. Depths and paths are fractions of the hand's reach, not lengths.

#include <array>
#include <cstdint>
#include <vector>

#include <nendo/base/side.hpp>
#include <nendo/hand/joints.hpp>

namespace nendo::motions {

/// Goes from 0 to 1, at rest at both ends; it is 0 before and 1 after. Arm and hand movements from
/// rest to rest have the least jerk that their ends allow (Flash and Hogan 1985), which makes them
/// a polynomial of time.
double min_jerk(double part) noexcept;

struct TouchStroke {
  double begin_s, rise_s, hold_s, fall_s;
  double depth; ///< 1: as deep in as the finger presses; -1: as far out as it pulls

  double end_s() const noexcept { return begin_s + rise_s + hold_s + fall_s; }
  double apex_s() const noexcept { return begin_s + rise_s + 0.5 * hold_s; }
};

/// A glide along the finger's way, which runs from 0 to 1.
struct TouchGlide {
  double begin_s, length_s;
  double from, to;
};

/// A cycle that begins and ends at rest, on the surface, at the way's beginning. Fingers press or
/// pull only while none glides.
class TouchScore {
public:
  /// The same seed gives the same score, and another seed gives another one. The two sides do not
  /// move in step.
  TouchScore(Side side, std::uint32_t seed);

  double period_s() const noexcept { return period_s_; }
  /// Returns the depth at any time. It is twice continuously differentiable, as real hands'
  /// movements are.
  double depth(hand::Finger finger, double time_s) const noexcept;
  double way(double time_s) const noexcept;
  /// Returns the times at which the fingers go farthest.
  std::vector<double> extremes_s() const;

private:
  using Strokes = std::vector<TouchStroke>;

  std::array<Strokes, hand::finger_count> strokes_;
  std::vector<TouchGlide> glides_;
  double period_s_ = 0.0;
};

} // namespace nendo::motions
