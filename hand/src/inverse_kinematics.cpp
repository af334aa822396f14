#include <nendo/hand/inverse_kinematics.hpp>

#include <algorithm>
#include <cmath>

#include "angle_rows.hpp"
#include "fingertip.hpp"

namespace nendo::hand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// How strongly posture counts beside a fingertip's distance, as the distance that a radian is
// worth. It forms the hand in a first stage, and is left out of the second, which reaches.
struct Posture {
  double start_m = 0.0;    ///< stay where it was
  double shared_m = 0.0;   ///< likewise, of palm and wrist: a hand reaches with its fingers first
  double together_m = 0.0; ///< the last two joints bend together
};
constexpr Posture forming{0.0005, 0.020, 0.004};
constexpr Posture reaching{};

/// The last joint bends with the one before it. A finger's DIP by the rule of joint_angles.hpp,
/// 0.32 PIP^2 + 0.17 PIP; a thumb's IP by 0.5 MCP; of bent joints. `block` is where its four angles
/// stand.
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

/// Where the wrist's own angles turn the hand.
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
  Vector3d place_m = Vector3d::Zero(); ///< a right hand's, in the frame of the forearm's end
  double weight = 0.0;                 ///< 1 at most; 0: none
};
using Aims = std::array<Aim, finger_count>;

/// The whole hand, its wrist and its palm included.
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

constexpr Effort to_form{25, 0.0, 1e-3};
constexpr Effort to_reach(double enough_m) {
  return {25, enough_m, 1e-7};
}

struct Reached {
  FourAngles angles;
  double residual_m = 0.0;
  int iterations = 0;
};

// Where to begin again when the way from the start ended at the ends of the ranges: parts of each
// range. Found by looking where the nearest of many random poses was nearer than the best so far.
// With these, every one of 20,000 targets in reach was reached, and two of 7,500 out of reach had a
// nearer pose that was not found.
using Parts = std::array<double, 4>;
constexpr std::array<Parts, 9> other_finger_starts{{
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
constexpr std::array<Parts, 9> other_thumb_starts{{
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

/// What another pose must gain to be worth a jump away from the start.
constexpr double worth_a_jump_m = 5e-5;

/// Forms the finger and reaches; where that does not arrive, reaches from elsewhere.
Reached solve_finger(FingerProblem problem, const Box<4>& box, double enough_m) noexcept {
  NormalEquations<4> here;
  Reached best{problem.start};
  problem.posture = forming;
  best.iterations = minimise<4>(problem, box, to_form, best.angles, here);
  problem.posture = reaching;
  best.iterations += minimise<4>(problem, box, to_reach(enough_m), best.angles, here);
  best.residual_m = here.farthest_m;
  for (const Parts& parts : problem.thumb ? other_thumb_starts : other_finger_starts) {
    if (best.residual_m <= enough_m) break;
    FourAngles at;
    for (Eigen::Index k = 0; k < 4; ++k)
      at[k] = box.low[k] + parts[static_cast<std::size_t>(k)] * (box.high[k] - box.low[k]);
    best.iterations += minimise<4>(problem, box, to_reach(enough_m), at, here);
    const bool better =
        here.farthest_m <= enough_m || here.farthest_m < best.residual_m - worth_a_jump_m;
    if (!better) continue;
    best.angles = at;
    best.residual_m = here.farthest_m;
  }
  return best;
}

/// Palm and wrist stay where they are unless they are to be solved.
Box<row_size> freed(Box<row_size> box, const AllAngles& at,
                    const InverseOptions& options) noexcept {
  const auto hold = [&](int k) { box.low[k] = box.high[k] = at[k]; };
  if (!options.solve_palm_arch) hold(arch_at);
  if (!options.solve_wrist) {
    hold(pitch_at);
    hold(yaw_at);
  }
  return box;
}

/// Whole hand: palm and wrist as far as `box` lets them move.
int solve_hand(const Chains& chains, const Aims& aims, const Box<row_size>& box, double enough_m,
               AllAngles& at) noexcept {
  HandProblem problem{chains, aims, at, forming};
  NormalEquations<row_size> here;
  int iterations = minimise<row_size>(problem, box, to_form, at, here);
  problem.posture = reaching;
  iterations += minimise<row_size>(problem, box, to_reach(enough_m), at, here);
  return iterations;
}

Aims aims_of(const FingertipTargets& targets, const Eigen::Isometry3d& T_world_wrist,
             Side side) noexcept {
  Aims aims;
  double heaviest = 0.0;
  for (std::size_t f = 0; f < finger_count; ++f) {
    const FingertipTarget& target = targets[f];
    Vector3d place_m =
        T_world_wrist.linear().transpose() * (target.position_m - T_world_wrist.translation());
    if (side == Side::left) place_m.x() = -place_m.x();
    // Written so that a NaN is refused, of the wrist's pose, too.
    const bool usable = target.weight > 0.0 && std::isfinite(target.weight) &&
                        place_m.cwiseAbs().sum() <= FingertipTarget::farthest_m;
    if (!usable) continue;
    aims[f] = {place_m, target.weight};
    heaviest = std::max(heaviest, target.weight);
  }
  for (Aim& aim : aims) {
    // Tips that hardly count would be lost in rounding.
    if (aim.weight > 0.0) aim.weight = std::max(aim.weight / heaviest, 1e-6);
  }
  return aims;
}

} // namespace

InverseSolution inverse_kinematics(const HandSkeleton& skeleton,
                                   const Eigen::Isometry3d& T_world_wrist,
                                   const FingertipTargets& targets, const JointAngles& start,
                                   const InverseOptions& options) noexcept {
  const Chains chains{FingerChain(skeleton, 0), FingerChain(skeleton, 1), FingerChain(skeleton, 2),
                      FingerChain(skeleton, 3), FingerChain(skeleton, 4)};
  const Aims aims = aims_of(targets, T_world_wrist, skeleton.side());
  const double enough_m = options.tolerance_m > 1e-9 ? options.tolerance_m : 1e-9;
  const Box<row_size> box = box_of(options.limits);
  AllAngles at = clamped(row_of(start), box);
  InverseSolution solution;
  int iterations = 0;
  if (options.solve_wrist || options.solve_palm_arch) {
    iterations += solve_hand(chains, aims, freed(box, at, options), enough_m, at);
  }
  const Matrix3d turn = wrist_turn(at[pitch_at], at[yaw_at]);
  solution.converged = true;
  for (std::size_t f = 0; f < finger_count; ++f) {
    if (!(aims[f].weight > 0.0)) continue;
    const auto block = 4 * static_cast<Eigen::Index>(f);
    const FingerProblem problem{
        chains[f], f == 0, turn.transpose() * aims[f].place_m, at[arch_at], at.segment<4>(block),
        {}};
    const Box<4> own{box.low.segment<4>(block), box.high.segment<4>(block)};
    const Reached reached = solve_finger(problem, own, enough_m);
    at.segment<4>(block) = reached.angles;
    solution.residual_m[f] = reached.residual_m;
    iterations += reached.iterations;
    solution.converged = solution.converged && reached.residual_m <= enough_m;
  }
  solution.angles = angles_of(at);
  solution.iterations = static_cast<unsigned>(iterations);
  return solution;
}

} // namespace nendo::hand
