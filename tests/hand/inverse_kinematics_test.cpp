#include <nendo/hand/inverse_kinematics.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "support/hand_targets.hpp"
#include "support/restraint.hpp"

namespace inverse_kinematics_test {

using namespace nendo;
using namespace nendo::hand;
using namespace nendo::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;

TEST_SUITE("inverse_kinematics") {
  TEST_CASE("what a hand can reach is reached to 0.1 mm, from the rest pose and from nearby") {
    std::mt19937 random(1);
    for (int round = 0; round < 2000; ++round) {
      const Side side = round % 2 == 0 ? Side::left : Side::right;
      const HandSkeleton skeleton(side);
      const JointAngles made_of = random_angles_within_limits(random);
      const Isometry3d base = random_place(random);
      const auto targets = targets_at(skeleton.pose(made_of, base).fingertip_positions());
      for (const JointAngles& start :
           {resting_with_wrist_of(made_of), near(made_of, 0.2, random)}) {
        const auto solution = inverse_kinematics(skeleton, base, targets, start);
        const auto off = distances(skeleton, base, targets, solution.angles);
        CAPTURE(round);
        REQUIRE(most(off) < tenth_mm);
        REQUIRE(solution.converged);
        REQUIRE(within(default_angle_limits(), solution.angles));
        for (std::size_t f = 0; f < finger_count; ++f)
          REQUIRE(std::abs(solution.residual_m[f] - off[f]) < 1e-12);
      }
    }
  }

  TEST_CASE("a wearer's own bones and narrow limits are kept to") {
    std::mt19937 random(2);
    AngleLimits narrow = default_angle_limits();
    for (auto& finger : narrow.low.fingers)
      finger.mcp_flexion_rad = finger.pip_flexion_rad = finger.dip_flexion_rad = 0.1;
    for (auto& finger : narrow.high.fingers)
      finger.mcp_flexion_rad = finger.pip_flexion_rad = finger.dip_flexion_rad = 0.9;
    HandSize size;
    size.shape[ShapeTerm::index_proximal] = 0.3;
    size.shape[ShapeTerm::thumb_proximal] = -0.4;
    const HandSkeleton skeleton(Side::right, size);
    InverseOptions options;
    options.limits = narrow;
    for (int round = 0; round < 500; ++round) {
      JointAngles inside = random_angles_within_limits(random);
      std::uniform_real_distribution<double> bend(0.1, 0.9);
      for (auto& f : inside.fingers)
        f = {bend(random), f.mcp_abduction_rad, bend(random), bend(random)};
      const Isometry3d base = random_place(random);
      const auto targets = targets_at(skeleton.pose(inside, base).fingertip_positions());
      const auto solution =
          inverse_kinematics(skeleton, base, targets, resting_with_wrist_of(inside), options);
      REQUIRE(most(distances(skeleton, base, targets, solution.angles)) < tenth_mm);
      REQUIRE(within(narrow, solution.angles));
    }
  }

  TEST_CASE("no pose within the limits comes nearer to what is out of reach") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    const HandSkeleton skeleton(Side::right);
    const Isometry3d base = Isometry3d::Identity();
    std::vector<Eigen::Matrix<double, 3, 5>> elsewhere;
    for (int k = 0; k < 5000; ++k) {
      JointAngles angles = random_angles_within_limits(random);
      angles.palm_arch_rad = angles.wrist_pitch_rad = angles.wrist_yaw_rad = 0.0;
      elsewhere.push_back(skeleton.pose(angles, base).fingertip_positions());
    }
    int out_of_reach = 0;
    for (int round = 0; round < 200; ++round) {
      FingertipTargets targets;
      for (auto& target : targets)
        target = {0.3 * Vector3d(u(random), u(random), u(random) - 0.3), 1.0};
      const auto solution = inverse_kinematics(skeleton, base, targets, {});
      REQUIRE(within(default_angle_limits(), solution.angles));
      const auto off = distances(skeleton, base, targets, solution.angles);
      for (std::size_t f = 0; f < finger_count; ++f) {
        REQUIRE(std::abs(solution.residual_m[f] - off[f]) < 1e-12);
        double nearest = 1.0;
        for (const auto& tips : elsewhere) {
          const auto tip = tips.col(static_cast<Eigen::Index>(f));
          nearest = std::min(nearest, (tip - targets[f].position_m).norm());
        }
        CAPTURE(round);
        CAPTURE(f);
        CHECK(off[f] < nearest + tenth_mm);
        out_of_reach += off[f] > tenth_mm ? 1 : 0;
      }
      CHECK(solution.converged == (most(off) <= InverseOptions{}.tolerance_m));
    }
    CHECK(out_of_reach > 500);
  }

  TEST_CASE("a finger without a target keeps its angles, and so do palm and wrist") {
    std::mt19937 random(4);
    const HandSkeleton skeleton(Side::left);
    for (int round = 0; round < 100; ++round) {
      const JointAngles start = random_angles_within_limits(random);
      JointAngles there = random_angles_within_limits(random);
      there.palm_arch_rad = start.palm_arch_rad;
      there.wrist_pitch_rad = start.wrist_pitch_rad;
      there.wrist_yaw_rad = start.wrist_yaw_rad;
      FingertipTargets targets =
          targets_at(skeleton.pose(there, Isometry3d::Identity()).fingertip_positions());
      for (std::size_t f : {0U, 2U, 3U, 4U})
        targets[f].weight = 0.0;
      JointAngles solved =
          inverse_kinematics(skeleton, Isometry3d::Identity(), targets, start).angles;
      CHECK(farthest_apart(solved, start) > 0.0);
      solved[Finger::index] = start[Finger::index];
      CHECK(farthest_apart(solved, start) == 0.0);
    }
  }

  TEST_CASE("thumb and index finger meet where both are sent") {
    for (const Side side : {Side::left, Side::right}) {
      const HandSkeleton skeleton(side);
      // In front of the index finger's second joint, as one holds a pea.
      const double across = side == Side::left ? 0.030 : -0.030;
      FingertipTargets targets;
      targets[0] = targets[1] = {Vector3d(across, -0.050, -0.120), 1.0};
      const auto solution = inverse_kinematics(skeleton, Isometry3d::Identity(), targets, {});
      const HandPose pose = skeleton.pose(solution.angles, Isometry3d::Identity());
      CHECK((pose[Joint::thumb_tip].translation() - pose[Joint::index_tip].translation()).norm() <
            tenth_mm);
      CHECK(solution.converged);
    }
  }

  TEST_CASE("bent as fingers bend of themselves, a finger is found again") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> mcp(0.0, 1.2);
    std::uniform_real_distribution<double> pip(0.3, 1.5);
    const HandSkeleton skeleton(Side::right);
    for (int round = 0; round < 300; ++round) {
      JointAngles natural;
      for (auto& f : natural.fingers) {
        f.mcp_flexion_rad = mcp(random);
        f.pip_flexion_rad = pip(random);
        // The vendor library's rule for gloves without DIP sensors.
        f.dip_flexion_rad = 0.32 * f.pip_flexion_rad * f.pip_flexion_rad + 0.17 * f.pip_flexion_rad;
      }
      auto targets =
          targets_at(skeleton.pose(natural, Isometry3d::Identity()).fingertip_positions());
      targets[0].weight = 0.0;
      const auto solved = inverse_kinematics(skeleton, Isometry3d::Identity(), targets, {}).angles;
      CAPTURE(round);
      CHECK(farthest_apart(solved, natural) < 0.01);
    }
  }

  TEST_CASE("a target that moves by a millimetre does not make the hand jump") {
    const HandSkeleton skeleton(Side::right);
    JointAngles open;
    JointAngles closed;
    for (auto& f : open.fingers)
      f = {0.1, 0.0, 0.2, 0.05};
    for (auto& f : closed.fingers)
      f = {1.1, 0.0, 1.5, 0.9};
    const auto from = skeleton.pose(open, Isometry3d::Identity()).fingertip_positions();
    const auto to = skeleton.pose(closed, Isometry3d::Identity()).fingertip_positions();
    JointAngles at = open;
    at = inverse_kinematics(skeleton, Isometry3d::Identity(), targets_at(from), at).angles;
    const int steps = 200; // of at most a millimetre
    for (int step = 1; step <= steps; ++step) {
      const double part = static_cast<double>(step) / steps;
      const auto next = inverse_kinematics(skeleton, Isometry3d::Identity(),
                                           targets_at((1.0 - part) * from + part * to), at)
                            .angles;
      CAPTURE(step);
      CHECK(farthest_apart(at, next) < 0.15);
      at = next;
    }
  }

  TEST_CASE("wrist and palm help only where they are asked, and then reach farther") {
    std::mt19937 random(6);
    const HandSkeleton skeleton(Side::left);
    InverseOptions all;
    all.solve_wrist = all.solve_palm_arch = true;
    int farther = 0;
    int reached = 0;
    for (int round = 0; round < 300; ++round) {
      const JointAngles made_of = random_angles_within_limits(random);
      const Isometry3d base = random_place(random);
      const auto targets = targets_at(skeleton.pose(made_of, base).fingertip_positions());
      JointAngles start = made_of;
      start.wrist_pitch_rad *= 0.7;
      start.wrist_yaw_rad += 0.1;
      start.palm_arch_rad *= 0.5;
      const auto fixed = inverse_kinematics(skeleton, base, targets, start);
      const auto free = inverse_kinematics(skeleton, base, targets, start, all);
      const double off_fixed = most(distances(skeleton, base, targets, fixed.angles));
      const double off_free = most(distances(skeleton, base, targets, free.angles));
      CAPTURE(round);
      CHECK(off_free < 20 * tenth_mm); // seldom, it ends at the ends of the ranges
      CHECK(free.converged == (off_free <= all.tolerance_m));
      reached += off_free < tenth_mm ? 1 : 0;
      CHECK(within(default_angle_limits(), free.angles));
      farther += off_fixed > 10 * tenth_mm ? 1 : 0;
      CHECK(fixed.angles.wrist_pitch_rad == doctest::Approx(start.wrist_pitch_rad));
    }
    CHECK(farther > 30);
    CHECK(reached >= 299);
  }

  TEST_CASE("a heavier tip is nearer, when the wrist cannot please all") {
    const HandSkeleton skeleton(Side::right);
    InverseOptions options;
    options.solve_wrist = true;
    const auto off_with = [&](double index_weight) {
      FingertipTargets targets;
      targets[1] = {Vector3d(-0.15, 0.10, -0.20), index_weight};
      targets[4] = {Vector3d(0.15, -0.10, -0.20), 1.0};
      const auto solution =
          inverse_kinematics(skeleton, Isometry3d::Identity(), targets, {}, options);
      return distances(skeleton, Isometry3d::Identity(), targets, solution.angles);
    };
    const auto heavy = off_with(10.0);
    const auto light = off_with(0.1);
    CHECK(heavy[1] < light[1] - 0.005);
    CHECK(heavy[4] > light[4] + 0.005);
  }

  TEST_CASE("whatever it is given, the result is finite, within the limits, and the same again") {
    std::mt19937 random(7);
    const double strange[] = {0.0,
                              -1.0,
                              1e-300,
                              1e300,
                              -1e9,
                              999.0,
                              std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::denorm_min()};
    const auto any = [&] { return strange[random() % std::size(strange)]; };
    for (int round = 0; round < 1000; ++round) {
      const HandSkeleton skeleton(round % 2 == 0 ? Side::left : Side::right);
      FingertipTargets targets;
      for (auto& target : targets)
        target = {Vector3d(any(), 0.1 * any(), any()), any()};
      Isometry3d base = random_place(random);
      if (round % 3 == 0) base.translation().y() = any();
      if (round % 5 == 0) base.linear()(1, 2) = any();
      JointAngles start;
      InverseOptions options;
      for (double* angle : angles_in(start))
        *angle = any();
      for (double* low : angles_in(options.limits.low))
        if (random() % 4 == 0) *low = any();
      options.solve_wrist = random() % 2 == 0;
      options.solve_palm_arch = random() % 2 == 0;
      if (round % 7 == 0) options.tolerance_m = any();
      const auto solution = inverse_kinematics(skeleton, base, targets, start, options);
      JointAngles angles = solution.angles;
      const AngleLimits limits = default_angle_limits();
      AngleLimits asked = options.limits;
      const auto lows = angles_in(asked.low);
      const auto highs = angles_in(asked.high);
      AngleLimits used = limits;
      const auto used_low = angles_in(used.low);
      const auto all = angles_in(angles);
      for (std::size_t k = 0; k < all.size(); ++k) {
        const bool kept = *lows[k] >= -7.0 && *lows[k] <= *highs[k];
        REQUIRE(std::isfinite(*all[k]));
        REQUIRE(*all[k] >= (kept ? *lows[k] : *used_low[k]));
        REQUIRE(*all[k] <= *highs[k]);
      }
      for (const double residual_m : solution.residual_m)
        REQUIRE(std::isfinite(residual_m));
      REQUIRE(farthest_apart(inverse_kinematics(skeleton, base, targets, start, options).angles,
                             solution.angles) == 0.0);
    }
  }

  TEST_CASE("solving allocates nothing and takes no lock") {
    const HandSkeleton skeleton(Side::right);
    std::mt19937 random(8);
    const auto targets =
        targets_at(skeleton.pose(random_angles_within_limits(random), Isometry3d::Identity())
                       .fingertip_positions());
    InverseOptions options;
    options.solve_wrist = options.solve_palm_arch = true;
    const test::Restraint restraint;
    const auto solution =
        inverse_kinematics(skeleton, Isometry3d::Identity(), targets, {}, options);
    const auto pose = skeleton.pose(solution.angles, Isometry3d::Identity());
    const auto counts = restraint.counts();
    CHECK(pose[Joint::index_tip].translation().allFinite());
    CHECK(counts.allocations == 0);
    CHECK(counts.locks == 0);
    if (test::restraint_is_counted) { // the control
      const std::vector<int> allocated(1 + random() % 100);
      CHECK(restraint.counts().allocations > counts.allocations);
      CHECK(!allocated.empty());
    }
  }
}

} // namespace inverse_kinematics_test
