#pragma once
// One finger's part of inverse kinematics: finds its four angles from a place for its tip, with the
// palm held still. Also defines what makes a posture natural, which the solver for the whole hand
// needs.

#include <algorithm>

#include "bounded_least_squares.hpp"
#include "fingertip.hpp"

namespace nendo::hand {

// How strongly posture counts compared with the distance of a fingertip: each weight is the
// distance that one radian is worth. Posture shapes the hand in a first stage. The second stage,
// which reaches for the target, leaves it out.
struct Posture {
  double start_m = 0.0;    ///< joints stay where they were
  double shared_m = 0.0;   ///< likewise for palm and wrist: a hand reaches with its fingers first
  double together_m = 0.0; ///< the last two joints bend together
};
inline constexpr Posture forming{0.0005, 0.020, 0.004};
inline constexpr Posture reaching{};

/// Adds to `sum` that the last joint bends with the one before it: a finger's DIP by the rule of
/// joint_angles.hpp, 0.32 PIP^2 + 0.17 PIP, and a thumb's IP by 0.5 MCP, of bent joints. `block` is
/// the index of the first of the finger's four angles in `at`.
template <int N>
void add_together(NormalEquations<N>& sum, const Eigen::Matrix<double, N, 1>& at, int block,
                  bool thumb, double together_m) noexcept {
  const double bent = std::max(at[block + 2], 0.0);
  const double follows = thumb ? 0.5 * bent : (0.32 * bent + 0.17) * bent;
  const double slope = at[block + 2] <= 0.0 ? 0.0 : thumb ? 0.5 : 0.64 * bent + 0.17;
  const double apart = at[block + 3] - follows;
  const Eigen::Vector2d row(-slope, 1.0);
  const double weight = together_m * together_m;
  sum.matrix.template block<2, 2>(block + 2, block + 2) += weight * row * row.transpose();
  sum.gradient.template segment<2>(block + 2) += weight * apart * row;
  sum.cost += 0.5 * weight * apart * apart;
}

inline constexpr Effort to_form{25, 0.0, 1e-3};
constexpr Effort to_reach(double enough_m) noexcept {
  return {25, enough_m, 1e-7};
}

/// A place from which to start again when the search from the given start ended at the ends of the
/// ranges: parts of each range.
using Parts = std::array<double, 4>;
inline constexpr std::size_t other_starts = 9;
const Parts& other_start(std::size_t number, bool thumb) noexcept;
FourAngles part_of(const Box<4>& box, const Parts& parts) noexcept;

/// How much nearer another pose must be to be worth a jump away from the start.
inline constexpr double worth_a_jump_m = 5e-5;

struct Reached {
  FourAngles angles;
  double residual_m = 0.0;
  int iterations = 0;
};

/// Shapes the finger and reaches for the target; if it does not arrive, reaches from other starts.
/// The target is in the frame of a right hand's wrist joint, after the wrist's own angles.
/// Wait-free.
Reached reach(const FingerChain& chain, bool thumb, const Eigen::Vector3d& target_m,
              double palm_arch_rad, const FourAngles& start, const Box<4>& box,
              double enough_m) noexcept;

} // namespace nendo::hand
