#include <nendo/hand/inverse_kinematics.hpp>

#include <algorithm>
#include <cmath>

#include "angle_rows.hpp"
#include "finger_reach.hpp"
#include "hand_ik.hpp"

namespace nendo::hand {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Palm and wrist stay where they are unless they are to be solved.
Box<row_size> freed(Box<row_size> box, const AllAngles& at, bool wrist, bool arch) noexcept {
  const auto hold = [&](int k) { box.low[k] = box.high[k] = at[k]; };
  if (!arch) hold(arch_at);
  if (!wrist) {
    hold(pitch_at);
    hold(yaw_at);
  }
  return box;
}

/// The heaviest target's, or 0.
double heaviest(const Aims& aims) noexcept {
  double most = 0.0;
  for (const Aim& aim : aims)
    most = std::max(most, aim.weight);
  return most;
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

/// A right hand's from a left one's, and back.
Isometry3d mirrored(Isometry3d pose) noexcept {
  const Vector3d mirror(-1.0, 1.0, 1.0);
  pose.linear() = mirror.asDiagonal() * pose.linear() * mirror.asDiagonal();
  pose.translation().x() = -pose.translation().x();
  return pose;
}

PalmAim palm_aim_of(const HandSkeleton& skeleton, const Isometry3d& T_world_wrist,
                    const PalmTarget& target) noexcept {
  PalmAim aim;
  if (!(target.weight > 0.0) || !std::isfinite(target.weight)) return aim;
  aim.rest = skeleton.pose({}, Isometry3d::Identity())[Joint::palm];
  aim.wanted = T_world_wrist.inverse(Eigen::Isometry) * target.T_world_palm;
  if (skeleton.side() == Side::left) {
    aim.rest = mirrored(aim.rest);
    aim.wanted = mirrored(aim.wanted);
  }
  const Matrix3d& axes = aim.wanted.linear();
  const bool usable =
      aim.wanted.translation().cwiseAbs().sum() <= FingertipTarget::farthest_m &&
      (axes * axes.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-3 &&
      axes.determinant() > 0.0;
  if (usable) aim.weight = target.weight;
  return aim;
}

/// Weights as parts of the heaviest; what hardly counts would be lost in rounding.
void normalise(Aims& aims, PalmAim& palm) noexcept {
  const double most = std::max(heaviest(aims), palm.weight);
  const auto part = [&](double& weight) {
    if (weight > 0.0) weight = std::max(weight / most, 1e-6);
  };
  for (Aim& aim : aims)
    part(aim.weight);
  part(palm.weight);
}

struct Attempt {
  AllAngles at;
  std::array<double, finger_count> residual_m{};
  double farthest_m = 0.0;
  double badness = 0.0; ///< weighted squares; what attempts are compared by
  int iterations = 0;
};

/// Fingers one by one, with palm and wrist where they are.
Attempt reach_all(const HandIk& hand, const Box<row_size>& box, const AllAngles& from,
                  double enough_m) noexcept {
  Attempt attempt{from};
  const Matrix3d turn = wrist_turn(from[pitch_at], from[yaw_at]);
  for (std::size_t f = 0; f < finger_count; ++f) {
    if (!(hand.aims[f].weight > 0.0)) continue;
    const auto block = 4 * static_cast<Eigen::Index>(f);
    const Box<4> own{box.low.segment<4>(block), box.high.segment<4>(block)};
    const Reached reached = reach(hand.chains[f], f == 0, turn.transpose() * hand.aims[f].place_m,
                                  from[arch_at], from.segment<4>(block), own, enough_m);
    attempt.at.segment<4>(block) = reached.angles;
    attempt.residual_m[f] = reached.residual_m;
    attempt.farthest_m = std::max(attempt.farthest_m, reached.residual_m);
    attempt.badness += hand.aims[f].weight * reached.residual_m * reached.residual_m;
    attempt.iterations += reached.iterations;
  }
  attempt.badness += hand.palm.weight * hand.palm_off_m(turn) * hand.palm_off_m(turn);
  return attempt;
}

/// Palm and wrist: downhill from `start`, and where that does not arrive, from other fingers.
Attempt reach_with_hand(const HandIk& hand, const Box<row_size>& box, const Box<row_size>& free,
                        const AllAngles& start, double enough_m) noexcept {
  const auto try_from = [&](AllAngles at) {
    const int iterations = hand.solve(free, enough_m, at);
    Attempt attempt = reach_all(hand, box, at, enough_m);
    attempt.iterations += iterations;
    return attempt;
  };
  // A wrist that the palm has put where it belongs is not to be moved by fingers on their way.
  const Attempt as_it_is =
      hand.palm.weight > 0.0 ? reach_all(hand, box, start, enough_m) : Attempt{};
  if (hand.palm.weight > 0.0 && as_it_is.farthest_m <= enough_m) return as_it_is;
  Attempt best = try_from(start);
  int iterations = best.iterations + as_it_is.iterations;
  for (std::size_t number = 0; number < other_starts && best.farthest_m > enough_m; ++number) {
    AllAngles at = best.at;
    for (std::size_t f = 0; f < finger_count; ++f) {
      const auto block = 4 * static_cast<Eigen::Index>(f);
      const Box<4> own{box.low.segment<4>(block), box.high.segment<4>(block)};
      if (best.residual_m[f] > enough_m)
        at.segment<4>(block) = part_of(own, other_start(number, f == 0));
    }
    const Attempt next = try_from(at);
    iterations += next.iterations;
    const double gain_m = std::sqrt(best.badness) - std::sqrt(next.badness);
    if (next.farthest_m <= enough_m || gain_m > worth_a_jump_m) best = next;
  }
  best.iterations = iterations;
  return best;
}

} // namespace

InverseSolution inverse_kinematics(const HandSkeleton& skeleton, const Isometry3d& T_world_wrist,
                                   const FingertipTargets& targets, const JointAngles& start,
                                   const InverseOptions& options) noexcept {
  const Chains chains{FingerChain(skeleton, 0), FingerChain(skeleton, 1), FingerChain(skeleton, 2),
                      FingerChain(skeleton, 3), FingerChain(skeleton, 4)};
  Aims aims = aims_of(targets, T_world_wrist, skeleton.side());
  PalmAim palm = palm_aim_of(skeleton, T_world_wrist, options.palm);
  normalise(aims, palm);
  const double enough_m = options.tolerance_m > 1e-9 ? options.tolerance_m : 1e-9;
  const Box<row_size> box = box_of(options.limits);
  AllAngles at = clamped(row_of(start), box);
  const HandIk hand{chains, aims, palm};
  int iterations = 0;
  if (palm.weight > 0.0) {
    const Aims none{};
    iterations += HandIk{chains, none, palm}.solve(freed(box, at, true, false), enough_m, at);
  }
  const bool whole = options.solve_wrist || options.solve_palm_arch;
  const Attempt reached =
      whole
          ? reach_with_hand(hand, box, freed(box, at, options.solve_wrist, options.solve_palm_arch),
                            at, enough_m)
          : reach_all(hand, box, at, enough_m);
  InverseSolution solution;
  solution.angles = angles_of(reached.at);
  solution.residual_m = reached.residual_m;
  solution.iterations = static_cast<unsigned>(iterations + reached.iterations);
  solution.palm_off_m = palm.weight > 0.0
                            ? hand.palm_off_m(wrist_turn(reached.at[pitch_at], reached.at[yaw_at]))
                            : 0.0;
  solution.converged = reached.farthest_m <= enough_m;
  return solution;
}

} // namespace nendo::hand
