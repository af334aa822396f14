#include <nendo/hand/inverse_kinematics.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <nendo/hand/joint_limits.hpp>

#include "bounded_least_squares.hpp"
#include "fingertip.hpp"

// All is in the frame of the forearm's end, as a right hand's. A finger alone has four unknowns;
// with the palm's arch and the wrist, which the fingers share, all angles are solved at once.

namespace nendo::hand {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// All angles in one row, in the order of Angle: four for the thumb and for each finger, then those
// of the whole hand.
constexpr int arch_at = static_cast<int>(Angle::palm_arch);
constexpr int pitch_at = static_cast<int>(Angle::wrist_pitch);
constexpr int yaw_at = static_cast<int>(Angle::wrist_yaw);
constexpr int row_size = static_cast<int>(angle_count);
using AllAngles = Eigen::Matrix<double, row_size, 1>;

AllAngles angle_row(const JointAngles& angles) noexcept {
  AllAngles row;
  for (std::size_t n = 0; n < angle_count; ++n)
    row[static_cast<Eigen::Index>(n)] = angles[angle_at(n)];
  return row;
}

JointAngles angles_in(const AllAngles& row) noexcept {
  JointAngles angles;
  for (std::size_t n = 0; n < angle_count; ++n)
    angles[angle_at(n)] = row[static_cast<Eigen::Index>(n)];
  return angles;
}

/// Ranges that are not valid are replaced by the default ones.
Box<row_size> box_of(const AngleLimits& limits) noexcept {
  const AngleLimits usual = default_angle_limits();
  const Box<row_size> usual_box{angle_row(usual.low), angle_row(usual.high)};
  Box<row_size> box{angle_row(limits.low), angle_row(limits.high)};
  for (int k = 0; k < row_size; ++k) {
    constexpr double full_turn = 2.0 * std::numbers::pi;
    // Written so that a NaN is refused.
    if (box.low[k] >= -full_turn && box.low[k] <= box.high[k] && box.high[k] <= full_turn) continue;
    box.low[k] = usual_box.low[k];
    box.high[k] = usual_box.high[k];
  }
  return box;
}

/// An angle that is not finite counts as zero.
AllAngles clamped(AllAngles row, const Box<row_size>& box) noexcept {
  for (double& angle : row)
    angle = std::isfinite(angle) ? angle : 0.0;
  return row.cwiseMax(box.low).cwiseMin(box.high);
}

// How strongly posture counts compared with the distance of a fingertip: each weight is the
// distance that one radian is worth. Posture shapes the hand in a first stage. The second stage,
// which reaches for the target, leaves it out.
struct Posture {
  double start_m = 0.0;    ///< joints stay where they were
  double shared_m = 0.0;   ///< the same for palm and wrist: a hand reaches with its fingers first
  double together_m = 0.0; ///< the last two joints bend together
};
constexpr Posture forming{0.0005, 0.020, 0.004};
constexpr Posture reaching{};

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

constexpr Effort to_form{25, 0.0, 1e-3};
constexpr Effort to_reach(double enough_m) noexcept {
  return {25, enough_m, 1e-7};
}

/// A place from which to start again when the search from the given start ended at the ends of the
/// ranges: parts of each range.
using Parts = std::array<double, 4>;
constexpr std::size_t other_starts = 9;
constexpr double worth_a_jump_m = 5e-5; ///< how much nearer another pose must be

struct Reached {
  FourAngles angles;
  double residual_m = 0.0;
};

/// One finger of a hand that keeps still: four unknowns.
struct FingerProblem {
  const FingerChain& chain;
  bool thumb;
  Vector3d target_m; ///< in the frame of the wrist joint
  double palm_arch_rad;
  FourAngles start;
  Posture posture;

  NormalEquations<4> operator()(const FourAngles& at) const noexcept {
    const Fingertip tip = chain.tip(at, palm_arch_rad);
    const Vector3d off_m = tip.position_m - target_m;
    const double weight = posture.start_m * posture.start_m;
    NormalEquations<4> sum;
    sum.matrix.noalias() = tip.by_angle.transpose() * tip.by_angle;
    sum.matrix.diagonal().array() += weight;
    sum.gradient = weight * (at - start);
    sum.gradient.noalias() += tip.by_angle.transpose() * off_m;
    sum.farthest_m = off_m.norm();
    sum.cost = 0.5 * (off_m.squaredNorm() + weight * (at - start).squaredNorm());
    if (posture.together_m > 0.0) add_together<4>(sum, at, 0, thumb, posture.together_m);
    return sum;
  }
};

// Found by looking where the nearest of many random poses was nearer than the best so far.
// With these, every one of 20,000 targets in reach was reached, and two of 7,500 out of reach had a
// nearer pose that was not found.
constexpr std::array<Parts, other_starts> other_finger_starts{{
    {0.5, 0.5, 0.5, 0.5},
    {0.9, 0.5, 0.2, 0.2},
    {0.3, 0.3, 0.8, 0.6},
    {0.1, 0.9, 0.9, 0.9},
    {0.1, 0.1, 0.9, 0.9},
    {0.9, 0.9, 0.9, 0.9},
    {0.9, 0.1, 0.9, 0.2},
    {0.1, 0.1, 0.1, 0.1},
    {0.1, 0.1, 0.1, 0.9},
}};
constexpr std::array<Parts, other_starts> other_thumb_starts{{
    {0.5, 0.5, 0.5, 0.5},
    {0.1, 0.9, 0.3, 0.3},
    {0.9, 0.1, 0.3, 0.3},
    {0.1, 0.1, 0.9, 0.9},
    {0.9, 0.9, 0.9, 0.9},
    {0.9, 0.9, 0.1, 0.9},
    {0.1, 0.9, 0.9, 0.1},
    {0.9, 0.9, 0.1, 0.1},
    {0.1, 0.1, 0.1, 0.1},
}};

const Parts& other_start(std::size_t number, bool thumb) noexcept {
  return thumb ? other_thumb_starts[number] : other_finger_starts[number];
}

FourAngles angles_at_parts(const Box<4>& box, const Parts& parts) noexcept {
  FourAngles at;
  for (Eigen::Index k = 0; k < 4; ++k)
    at[k] = box.low[k] + parts[static_cast<std::size_t>(k)] * (box.high[k] - box.low[k]);
  return at;
}

/// Shapes the finger and reaches for the target; if it does not arrive, reaches from other starts.
/// The target is in the frame of the wrist joint, after the wrist's own angles.
Reached reach(const FingerChain& chain, bool thumb, const Vector3d& target_m, double palm_arch_rad,
              const FourAngles& start, const Box<4>& box, double enough_m) noexcept {
  FingerProblem problem{chain, thumb, target_m, palm_arch_rad, start, forming};
  NormalEquations<4> here;
  Reached best{start};
  minimise<4>(problem, box, to_form, best.angles, here);
  problem.posture = reaching;
  minimise<4>(problem, box, to_reach(enough_m), best.angles, here);
  best.residual_m = here.farthest_m;
  for (std::size_t number = 0; number < other_starts && best.residual_m > enough_m; ++number) {
    FourAngles at = angles_at_parts(box, other_start(number, thumb));
    minimise<4>(problem, box, to_reach(enough_m), at, here);
    const bool better =
        here.farthest_m <= enough_m || here.farthest_m < best.residual_m - worth_a_jump_m;
    if (!better) continue;
    best.angles = at;
    best.residual_m = here.farthest_m;
  }
  return best;
}

Matrix3d wrist_turn(double pitch_rad, double yaw_rad) noexcept {
  const double sp = std::sin(pitch_rad);
  const double cp = std::cos(pitch_rad);
  const double sy = std::sin(yaw_rad);
  const double cy = std::cos(yaw_rad);
  Matrix3d turn; // about Y by yaw, then about X by -pitch
  turn << cy, -sy * sp, sy * cp, 0.0, cp, sp, -sy, -cy * sp, cy * cp;
  return turn;
}

using Chains = std::array<FingerChain, finger_count>;

struct Aim {
  Vector3d place_m = Vector3d::Zero();
  double weight = 0.0; ///< 1 at most; 0: none
};
using Aims = std::array<Aim, finger_count>;

struct HandProblem {
  const Chains& chains;
  const Aims& aims;
  AllAngles start;
  Posture posture;

  NormalEquations<row_size> operator()(const AllAngles& at) const noexcept {
    NormalEquations<row_size> sum;
    sum.matrix.setZero();
    AllAngles weights = AllAngles::Constant(posture.start_m * posture.start_m);
    weights.tail<3>().setConstant(posture.shared_m * posture.shared_m);
    sum.matrix.diagonal() = weights;
    sum.gradient = weights.cwiseProduct(at - start);
    sum.cost = 0.5 * sum.gradient.dot(at - start);
    const Matrix3d turn = wrist_turn(at[pitch_at], at[yaw_at]);
    for (std::size_t f = 0; f < finger_count; ++f) {
      if (aims[f].weight > 0.0) add_finger(sum, f, at, turn);
    }
    return sum;
  }

private:
  void add_finger(NormalEquations<row_size>& sum, std::size_t f, const AllAngles& at,
                  const Matrix3d& turn) const noexcept {
    const auto block = 4 * static_cast<int>(f);
    const Fingertip tip = chains[f].tip(at.segment<4>(block), at[arch_at]);
    const Vector3d place_m = turn * tip.position_m;
    const Vector3d off_m = place_m - aims[f].place_m;
    const Eigen::Matrix<double, 3, 4> own = turn * tip.by_angle;
    Matrix3d shared; // by palm arch, pitch, yaw
    shared << turn * chains[f].by_arch(tip.position_m), -turn.col(0).cross(place_m),
        Vector3d::UnitY().cross(place_m);
    const double weight = aims[f].weight;
    sum.matrix.block<4, 4>(block, block) += weight * own.transpose() * own;
    sum.matrix.block<4, 3>(block, arch_at) += weight * own.transpose() * shared;
    sum.matrix.block<3, 4>(arch_at, block) += weight * shared.transpose() * own;
    sum.matrix.block<3, 3>(arch_at, arch_at) += weight * shared.transpose() * shared;
    sum.gradient.segment<4>(block) += weight * own.transpose() * off_m;
    sum.gradient.tail<3>() += weight * shared.transpose() * off_m;
    sum.cost += 0.5 * weight * off_m.squaredNorm();
    sum.farthest_m = std::max(sum.farthest_m, off_m.norm());
    if (posture.together_m > 0.0)
      add_together<row_size>(sum, at, block, f == 0, posture.together_m);
  }
};

/// Moves `at`, within `box`, until the fingertips are within `enough_m` of their aims, or no nearer
/// pose is found.
void solve_hand(const Chains& chains, const Aims& aims, const Box<row_size>& box, double enough_m,
                AllAngles& at) noexcept {
  HandProblem problem{chains, aims, at, forming};
  NormalEquations<row_size> here;
  minimise<row_size>(problem, box, to_form, at, here);
  problem.posture = reaching;
  minimise<row_size>(problem, box, to_reach(enough_m), at, here);
}

Box<row_size> freed(Box<row_size> box, const AllAngles& at, bool wrist, bool arch) noexcept {
  const auto hold = [&](int k) { box.low[k] = box.high[k] = at[k]; };
  if (!arch) hold(arch_at);
  if (!wrist) {
    hold(pitch_at);
    hold(yaw_at);
  }
  return box;
}

Aims aims_of(const FingertipTargets& targets, const Isometry3d& T_world_wrist, Side side) noexcept {
  Aims aims;
  for (std::size_t f = 0; f < finger_count; ++f) {
    const FingertipTarget& target = targets[f];
    Vector3d place_m =
        T_world_wrist.linear().transpose() * (target.position_m - T_world_wrist.translation());
    if (side == Side::left) place_m.x() = -place_m.x();
    // Written so that a NaN is refused, of the wrist's pose.
    const bool usable = target.weight > 0.0 && std::isfinite(target.weight) &&
                        place_m.cwiseAbs().sum() <= FingertipTarget::farthest_m;
    if (usable) aims[f] = {place_m, target.weight};
  }
  return aims;
}

/// Makes weights fractions of the largest; what hardly counts would be lost in rounding.
void normalise(Aims& aims) noexcept {
  double max = 0.0;
  for (const Aim& aim : aims)
    max = std::max(max, aim.weight);
  for (Aim& aim : aims)
    if (aim.weight > 0.0) aim.weight = std::max(aim.weight / max, 1e-6);
}

struct Attempt {
  AllAngles at;
  std::array<double, finger_count> residual_m{};
  double farthest_m = 0.0;
  double badness = 0.0; ///< weighted squares; what attempts are compared by
};

/// Fingers one by one, with palm and wrist where they are.
Attempt reach_all(const Chains& chains, const Aims& aims, const Box<row_size>& box,
                  const AllAngles& from, double enough_m) noexcept {
  Attempt attempt{from};
  const Matrix3d turn = wrist_turn(from[pitch_at], from[yaw_at]);
  for (std::size_t f = 0; f < finger_count; ++f) {
    if (!(aims[f].weight > 0.0)) continue;
    const auto block = 4 * static_cast<Eigen::Index>(f);
    const Box<4> own{box.low.segment<4>(block), box.high.segment<4>(block)};
    const Reached reached = reach(chains[f], f == 0, turn.transpose() * aims[f].place_m,
                                  from[arch_at], from.segment<4>(block), own, enough_m);
    attempt.at.segment<4>(block) = reached.angles;
    attempt.residual_m[f] = reached.residual_m;
    attempt.farthest_m = std::max(attempt.farthest_m, reached.residual_m);
    attempt.badness += aims[f].weight * reached.residual_m * reached.residual_m;
  }
  return attempt;
}

/// Palm and wrist: downhill from `start`, and where that does not arrive, from other fingers.
Attempt reach_with_hand(const Chains& chains, const Aims& aims, const Box<row_size>& box,
                        const Box<row_size>& free, const AllAngles& start,
                        double enough_m) noexcept {
  const auto try_from = [&](AllAngles at) {
    solve_hand(chains, aims, free, enough_m, at);
    return reach_all(chains, aims, box, at, enough_m);
  };
  Attempt best = try_from(start);
  for (std::size_t number = 0; number < other_starts && best.farthest_m > enough_m; ++number) {
    AllAngles at = best.at;
    for (std::size_t f = 0; f < finger_count; ++f) {
      const auto block = 4 * static_cast<Eigen::Index>(f);
      const Box<4> own{box.low.segment<4>(block), box.high.segment<4>(block)};
      if (best.residual_m[f] > enough_m)
        at.segment<4>(block) = angles_at_parts(own, other_start(number, f == 0));
    }
    const Attempt next = try_from(at);
    const double gain_m = std::sqrt(best.badness) - std::sqrt(next.badness);
    if (next.farthest_m <= enough_m || gain_m > worth_a_jump_m) best = next;
  }
  return best;
}

} // namespace

AngleLimits default_angle_limits() noexcept {
  AngleLimits limits;
  for (std::size_t n = 0; n < angle_count; ++n) {
    limits.low[angle_at(n)] = joint_limits[n].min_rad;
    limits.high[angle_at(n)] = joint_limits[n].max_rad;
  }
  return limits;
}

InverseSolution inverse_kinematics(const HandSkeleton& skeleton, const Isometry3d& T_world_wrist,
                                   const FingertipTargets& targets, const JointAngles& start,
                                   const InverseOptions& options) noexcept {
  const Chains chains{FingerChain(skeleton, 0), FingerChain(skeleton, 1), FingerChain(skeleton, 2),
                      FingerChain(skeleton, 3), FingerChain(skeleton, 4)};
  Aims aims = aims_of(targets, T_world_wrist, skeleton.side());
  normalise(aims);
  const double enough_m = options.tolerance_m > 1e-9 ? options.tolerance_m : 1e-9;
  const Box<row_size> box = box_of(options.limits);
  const AllAngles at = clamped(angle_row(start), box);
  const bool whole = options.solve_wrist || options.solve_palm_arch;
  const Box<row_size> free = freed(box, at, options.solve_wrist, options.solve_palm_arch);
  const Attempt reached = whole ? reach_with_hand(chains, aims, box, free, at, enough_m)
                                : reach_all(chains, aims, box, at, enough_m);
  InverseSolution solution;
  solution.angles = angles_in(reached.at);
  solution.residual_m = reached.residual_m;
  solution.converged = reached.farthest_m <= enough_m;
  return solution;
}

} // namespace nendo::hand
