#include <nendo/hand/pinch_closing.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "support/hand_targets.hpp"
#include "support/restraint.hpp"

namespace pinch_closing_test {

using namespace nendo;
using namespace nendo::hand;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/// By the whole hand's forward kinematics.
double gap_m(const HandSkeleton& skeleton, const JointAngles& angles, std::size_t finger) {
  const HandPose pose = skeleton.pose(angles, Isometry3d::Identity());
  return (pose[fingertips[0]] * skeleton.pad() - pose[fingertips[finger]] * skeleton.pad()).norm();
}

double min_gap_m(const HandSkeleton& skeleton, const JointAngles& angles) {
  double least = 1.0;
  for (std::size_t finger = 1; finger < finger_count; ++finger)
    least = std::min(least, gap_m(skeleton, angles, finger));
  return least;
}

double max_difference(const JointAngles& a, const JointAngles& b) {
  double most = 0.0;
  for (std::size_t at = 0; at < angle_count; ++at)
    most = std::max(most, std::abs(a[angle_at(at)] - b[angle_at(at)]));
  return most;
}

JointAngles between(const JointAngles& a, const JointAngles& b, double part) {
  JointAngles mixed;
  for (std::size_t at = 0; at < angle_count; ++at)
    mixed[angle_at(at)] = (1.0 - part) * a[angle_at(at)] + part * b[angle_at(at)];
  return mixed;
}

/// Any hand whose thumb's tip is near that of the finger, by inverse kinematics.
template <class Random>
JointAngles near_pinch(const HandSkeleton& skeleton, std::size_t finger, Random& random) {
  for (;;) {
    const JointAngles start = test::random_angles_within_limits(random);
    FingertipTargets targets{};
    targets[0].weight = 1.0;
    targets[0].position_m =
        skeleton.pose(start, Isometry3d::Identity())[fingertips[finger]].translation();
    const auto solution = inverse_kinematics(skeleton, Isometry3d::Identity(), targets, start);
    const double gap = gap_m(skeleton, solution.angles, finger);
    if (solution.converged && gap > 0.002 && gap < closed_pinch_m) return solution.angles;
  }
}

/// Neither another finger's pad pulls at the thumb nor is a joint at the end of its range.
bool is_free(const HandSkeleton& skeleton, const JointAngles& open, const JointAngles& closed,
             std::size_t finger) {
  for (std::size_t other = 1; other < finger_count; ++other)
    if (other != finger && gap_m(skeleton, open, other) < open_pinch_m) return false;
  for (std::size_t at = 0; at < 4 * finger_count; ++at) {
    const double angle = closed[angle_at(at)];
    if (angle <= joint_limits[at].min_rad || angle >= joint_limits[at].max_rad) return false;
  }
  return true;
}

} // namespace

TEST_SUITE("pinch_closing") {
  TEST_CASE(
      "pads that are nearly together meet, of either hand, and other joints keep their bits") {
    std::mt19937 random(1);
    int free = 0;
    for (int round = 0; round < 400; ++round) {
      HandSize size; // pads differ
      size.shape[ShapeTerm::pad_depth] = 0.001 * (round % 3 - 1);
      size.shape[ShapeTerm::pad_behind] = 0.002 * (round % 5 - 2);
      const HandSkeleton skeleton(round % 2 == 0 ? Side::left : Side::right, size);
      const auto finger = 1 + static_cast<std::size_t>(round / 2) % 4;
      const JointAngles open = near_pinch(skeleton, finger, random);
      const JointAngles closed = close_pinches(open, skeleton, sensors_22);
      CAPTURE(round);
      if (is_free(skeleton, open, closed, finger)) {
        ++free;
        REQUIRE(gap_m(skeleton, closed, finger) < 3e-4);
      }
      REQUIRE(max_difference(open, closed) < from_degrees(25.0));
      for (std::size_t at = 0; at < angle_count; ++at) {
        const double before = open[angle_at(at)], after = closed[angle_at(at)];
        const bool may_move = at < 4 || (at < 20 && gap_m(skeleton, open, at / 4) < open_pinch_m);
        if (!may_move) REQUIRE(before == after);
        REQUIRE(after >= std::min(before, joint_limits[at].min_rad));
        REQUIRE(after <= std::max(before, joint_limits[at].max_rad));
      }
    }
    CHECK(free > 250);
  }

  TEST_CASE("a hand whose pads are apart keeps its bits") {
    std::mt19937 random(2);
    const HandSkeleton skeleton(Side::right);
    int apart = 0;
    for (int round = 0; round < 2000; ++round) {
      const JointAngles angles = test::random_angles_within_limits(random);
      if (min_gap_m(skeleton, angles) < open_pinch_m) continue;
      ++apart;
      REQUIRE(max_difference(close_pinches(angles, skeleton, sensors_22), angles) == 0.0);
    }
    CHECK(apart > 1000);
  }

  TEST_CASE("while a pinch opens nothing jumps, and no gap is shown wider than it is") {
    std::mt19937 random(3);
    int opened = 0, compared = 0;
    for (int round = 0; round < 60; ++round) {
      const HandSkeleton skeleton(Side::right);
      const auto finger = 1 + static_cast<std::size_t>(round) % 4;
      const JointAngles pinch = near_pinch(skeleton, finger, random);
      JointAngles open = pinch;
      open.thumb_roll_rad -= 0.5;
      constexpr int steps = 2000;
      JointAngles before = close_pinches(pinch, skeleton, sensors_22);
      for (int step = 1; step <= steps; ++step) {
        const JointAngles given = between(pinch, open, 1.0 * step / steps);
        const JointAngles shown = close_pinches(given, skeleton, sensors_22);
        CAPTURE(round);
        CAPTURE(step);
        // The roll turns by 0.00025 rad a step.
        REQUIRE(max_difference(shown, before) < 0.006);
        if (is_free(skeleton, given, shown, finger)) {
          ++compared;
          REQUIRE(gap_m(skeleton, shown, finger) <= gap_m(skeleton, given, finger) + 1e-9);
        }
        before = shown;
      }
      if (min_gap_m(skeleton, open) < open_pinch_m) continue; // another finger's pad
      ++opened;
      CHECK(max_difference(before, open) == 0.0);
    }
    CHECK(opened > 20);
    CHECK(compared > 20'000);
  }

  TEST_CASE("an estimated joint turns more than a measured one") {
    const HandSkeleton skeleton(Side::right);
    std::mt19937 random(4);
    for (int round = 0; round < 50; ++round) {
      const JointAngles open = near_pinch(skeleton, 1, random);
      const auto turn = [&](SensorMask present) {
        const JointAngles closed = close_pinches(open, skeleton, present);
        return std::abs(closed[Finger::index].dip_flexion_rad -
                        open[Finger::index].dip_flexion_rad);
      };
      REQUIRE(turn(sensors_18) >= turn(sensors_22) - 1e-9);
    }
  }

  TEST_CASE("what is not finite comes back as it is, and no memory is allocated") {
    const HandSkeleton skeleton(Side::right);
    std::mt19937 random(5);
    const JointAngles pinch = near_pinch(skeleton, 1, random);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300})
      for (std::size_t at = 0; at < angle_count; ++at) {
        JointAngles angles = pinch;
        angles[angle_at(at)] = bad;
        const JointAngles closed = close_pinches(angles, skeleton, sensors_22);
        for (std::size_t other = 0; other < angle_count; ++other)
          if (other != at) REQUIRE(std::isfinite(closed[angle_at(other)]));
      }
    const test::Restraint restraint;
    const JointAngles closed = close_pinches(pinch, skeleton, sensors_22);
    CHECK(restraint.counts().allocations == 0);
    CHECK(max_difference(closed, pinch) > 0.0);
  }
}

} // namespace pinch_closing_test
