// nendo bench hand: how long a pose of both hands takes, beside the same by plain products of
// homogeneous matrices, and how many hands a second can be found from their fingertips.

#include <algorithm>
#include <chrono>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <nendo/hand/inverse_kinematics.hpp>
#include <nendo/hand/pinch_closing.hpp>

#include "bench/bench.hpp"
#include "bench/percentiles.hpp"
#include "bench/plain_hand.hpp"
#include "cli/cli.hpp"
#include "cli/print.hpp"

namespace nendo::bench::hand_bench {
namespace {

struct Options {
  std::uint64_t poses = 200'000;
  std::uint64_t solves = 20'000;
  bool json = false;
};
constexpr std::uint64_t most = 100'000'000;

/// Enough that the branch predictor cannot learn them, and few enough to stay in the cache.
constexpr std::size_t hands_made = 256;

struct Hands {
  hand::HandSkeleton left{Side::left};
  hand::HandSkeleton right{Side::right};
  std::vector<hand::JointAngles> angles; ///< within the limits
  Eigen::Isometry3d T_world_wrist = Eigen::Isometry3d::Identity();
};

Hands make_hands() {
  std::mt19937 random(1);
  const hand::AngleLimits limits = hand::default_angle_limits();
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Hands hands;
  for (std::size_t n = 0; n < hands_made; ++n) {
    hand::JointAngles angles;
    const auto draw = [&](auto member) {
      angles.*member = between(limits.low.*member, limits.high.*member);
    };
    draw(&hand::JointAngles::thumb_roll_rad);
    draw(&hand::JointAngles::thumb_abduction_rad);
    draw(&hand::JointAngles::thumb_mcp_flexion_rad);
    draw(&hand::JointAngles::thumb_ip_flexion_rad);
    draw(&hand::JointAngles::palm_arch_rad);
    draw(&hand::JointAngles::wrist_pitch_rad);
    draw(&hand::JointAngles::wrist_yaw_rad);
    for (std::size_t f = 0; f < angles.fingers.size(); ++f) {
      const auto bend = [&](auto member) {
        angles.fingers[f].*member =
            between(limits.low.fingers[f].*member, limits.high.fingers[f].*member);
      };
      bend(&hand::FingerAngles::mcp_flexion_rad);
      bend(&hand::FingerAngles::mcp_abduction_rad);
      bend(&hand::FingerAngles::pip_flexion_rad);
      bend(&hand::FingerAngles::dip_flexion_rad);
    }
    hands.angles.push_back(angles);
  }
  hands.T_world_wrist.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  hands.T_world_wrist.translation() = Eigen::Vector3d(0.1, 0.9, -0.3);
  return hands;
}

/// Prevents the compiler from removing unused results.
volatile double seen = 0.0;

/// Returns the median over blocks, so that interruptions do not change it. `work(n)` does the n-th
/// pair of hands.
template <class Work>
double median_ns(std::uint64_t count, const Work& work) {
  constexpr std::uint64_t block = 200;
  std::vector<double> times_ns;
  for (std::uint64_t done = 0; done < count; done += block) {
    const std::uint64_t size = std::min(block, count - done);
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint64_t n = 0; n < size; ++n)
      work((done + n) % hands_made);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    times_ns.push_back(took.count() / static_cast<double>(size));
  }
  return median(std::move(times_ns));
}

struct Forward {
  double pose_ns = 0.0; ///< time for both hands, 52 joints
  double plain_ns = 0.0;
  double apart_m = 0.0;  ///< max distance between the same joints of both
  double open_ns = 0.0;  ///< time of hand::close_pinches() for both hands, whose pads are apart
  double pinch_ns = 0.0; ///< the same where a finger's pad is near the thumb's
};

/// Some of these hands of which close_pinches() changes something, or does not.
std::vector<hand::JointAngles> of_pinches(const Hands& hands, bool pinching) {
  std::vector<hand::JointAngles> some;
  for (const hand::JointAngles& angles : hands.angles) {
    const auto closed = hand::close_pinches(angles, hands.right, sensors_22);
    bool changed = false;
    for (std::size_t at = 0; at < hand::angle_count; ++at)
      changed = changed || closed[hand::angle_at(at)] != angles[hand::angle_at(at)];
    if (changed == pinching) some.push_back(angles);
  }
  return some;
}

double measure_pinches_ns(const Hands& hands, std::uint64_t poses, bool pinching) {
  const auto some = of_pinches(hands, pinching);
  if (some.empty()) return 0.0;
  return median_ns(poses, [&](std::size_t n) {
    const auto& angles = some[n % some.size()];
    seen = hand::close_pinches(angles, hands.left, sensors_22).thumb_roll_rad +
           hand::close_pinches(angles, hands.right, sensors_22).thumb_roll_rad;
  });
}

Forward measure_forward(const Hands& hands, std::uint64_t poses) {
  Forward forward;
  const auto& T = hands.T_world_wrist;
  forward.pose_ns = median_ns(poses, [&](std::size_t n) {
    const auto left = hands.left.pose(hands.angles[n], T);
    const auto right = hands.right.pose(hands.angles[n], T);
    seen = left.joints[n % hand::joint_count](0, 3) + right.joints[n % hand::joint_count](1, 3);
  });
  forward.plain_ns = median_ns(std::max<std::uint64_t>(poses / 10, 1), [&](std::size_t n) {
    const auto left = plain_pose(hands.left, hands.angles[n], T);
    const auto right = plain_pose(hands.right, hands.angles[n], T);
    seen = left[n % hand::joint_count](0, 3) + right[n % hand::joint_count](1, 3);
  });
  for (const auto& angles : hands.angles) {
    for (const auto* skeleton : {&hands.left, &hands.right}) {
      const auto pose = skeleton->pose(angles, T);
      const auto plain = plain_pose(*skeleton, angles, T);
      for (std::size_t at = 0; at < hand::joint_count; ++at) {
        const double apart_m = (pose.joints[at].matrix() - plain[at]).topRightCorner<3, 1>().norm();
        forward.apart_m = std::max(forward.apart_m, apart_m);
      }
    }
  }
  forward.open_ns = measure_pinches_ns(hands, std::max<std::uint64_t>(poses / 10, 1), false);
  forward.pinch_ns = measure_pinches_ns(hands, std::max<std::uint64_t>(poses / 10, 1), true);
  return forward;
}

struct Inverse {
  double solves_a_second = 0.0; ///< whole hands
  double median_residual_m = 0.0;
  double worst_residual_m = 0.0; ///< that of any fingertip, by forward kinematics
  std::uint64_t solves = 0;
  std::uint64_t converged = 0;
};

/// Targets that the hand can reach, from the rest pose.
Inverse measure_inverse(const Hands& hands, std::uint64_t solves) {
  std::vector<hand::FingertipTargets> targets;
  std::vector<hand::JointAngles> starts;
  for (const auto& angles : hands.angles) {
    const auto tips = hands.right.pose(angles, hands.T_world_wrist).fingertip_positions();
    auto& target = targets.emplace_back();
    for (std::size_t f = 0; f < hand::finger_count; ++f)
      target[f] = {tips.col(static_cast<Eigen::Index>(f)), 1.0};
    hand::JointAngles& start = starts.emplace_back();
    start.palm_arch_rad = angles.palm_arch_rad;
    start.wrist_pitch_rad = angles.wrist_pitch_rad;
    start.wrist_yaw_rad = angles.wrist_yaw_rad;
  }
  Inverse inverse;
  inverse.solves = solves;
  const auto solve = [&](std::size_t n) {
    return hand::inverse_kinematics(hands.right, hands.T_world_wrist, targets[n], starts[n]);
  };
  const auto begin = std::chrono::steady_clock::now();
  for (std::uint64_t n = 0; n < solves; ++n)
    inverse.converged += solve(n % hands_made).converged ? 1U : 0U;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  inverse.solves_a_second = static_cast<double>(solves) / std::max(took.count(), 1e-9);

  std::vector<double> residuals_m;
  for (std::size_t n = 0; n < std::min<std::uint64_t>(hands_made, solves); ++n) {
    const auto tips = hands.right.pose(solve(n).angles, hands.T_world_wrist).fingertip_positions();
    for (std::size_t f = 0; f < hand::finger_count; ++f) {
      residuals_m.push_back(
          (tips.col(static_cast<Eigen::Index>(f)) - targets[n][f].position_m).norm());
    }
  }
  std::sort(residuals_m.begin(), residuals_m.end());
  inverse.median_residual_m = residuals_m[residuals_m.size() / 2];
  inverse.worst_residual_m = residuals_m.back();
  return inverse;
}

void print_json(const Forward& forward, const Inverse& inverse) {
  cli::print_line({{"pose_pair_ns", forward.pose_ns},
                   {"plain_pair_ns", forward.plain_ns},
                   {"plain_to_pose", forward.plain_ns / forward.pose_ns},
                   {"apart_m", forward.apart_m},
                   {"open_pair_ns", forward.open_ns},
                   {"pinching_pair_ns", forward.pinch_ns},
                   {"solves", inverse.solves},
                   {"converged", inverse.converged},
                   {"solves_a_second", inverse.solves_a_second},
                   {"median_residual_m", inverse.median_residual_m},
                   {"worst_residual_m", inverse.worst_residual_m}});
}

void print_text(const Forward& forward, const Inverse& inverse) {
  cli::print(
      "a pose of both hands, 52 joints: {:.0f} ns; plain products of matrices: {:.0f} ns, {:.1f} "
      "times as long\n",
      forward.pose_ns, forward.plain_ns, forward.plain_ns / forward.pose_ns);
  cli::print("they differ by {:.1e} m at most\n", forward.apart_m);
  cli::print(
      "closing pinches of both hands: {:.0f} ns where pads are apart, {:.0f} ns in a pinch\n",
      forward.open_ns, forward.pinch_ns);
  cli::print("a hand from its five fingertips: {:.0f} per second on one core, {} of {} converged\n",
             inverse.solves_a_second, inverse.converged, inverse.solves);
  cli::print("fingertips miss their targets by {:.1e} m (median), {:.1e} m (max)\n",
             inverse.median_residual_m, inverse.worst_residual_m);
}

int bench_hand(const Options& options) {
  const auto complain = [](const char* option) {
    return cli::report({Errc::usage, std::string(option) + ": use 1 to 100000000"});
  };
  if (options.poses == 0 || options.poses > most) return complain("--poses");
  if (options.solves == 0 || options.solves > most) return complain("--solves");
  const Hands hands = make_hands();
  const Forward forward = measure_forward(hands, options.poses);
  const Inverse inverse = measure_inverse(hands, options.solves);
  options.json ? print_json(forward, inverse) : print_text(forward, inverse);
  return 0;
}

} // namespace
} // namespace nendo::bench::hand_bench

void nendo::bench::add_hand(cli::Command& bench) {
  using namespace hand_bench;
  cli::Command command = bench.add_command(
      "hand",
      "Measures poses of both hands, beside plain products of matrices, and inverse kinematics");
  Options& options = command.on_chosen<Options>(bench_hand);
  command.add_option("--poses", options.poses, "Number of poses of both hands");
  command.add_option("--solves", options.solves,
                     "Number of hands to compute from their fingertips");
  command.add_flag("--json", options.json, "One JSON object");
}
