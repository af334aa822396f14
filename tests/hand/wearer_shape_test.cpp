// The shape of a wearer's hand: what it does to the skeleton, and that a calibration finds it.

#include <nendo/hand/wearer_shape.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/inverse_kinematics.hpp>

#include "support/hand_targets.hpp"
#include "support/held_poses.hpp"

namespace wearer_shape_test {

using namespace nendo;
using namespace nendo::hand;
using namespace nendo::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

WearerShape random_shape(std::mt19937& random, double part) {
  std::uniform_real_distribution<double> u(-part, part);
  WearerShape shape;
  for (std::size_t k = 0; k < shape_terms; ++k)
    shape.terms[k] = u(random) * max_of(static_cast<ShapeTerm>(k));
  return shape;
}

} // namespace

TEST_SUITE("wearer_shape") {
  TEST_CASE("inverse kinematics reaches with any shape what forward kinematics shows") {
    std::mt19937 random(31);
    for (int round = 0; round < 300; ++round) {
      HandSize size;
      size.shape = random_shape(random, 0.3);
      const Side side = round % 2 == 0 ? Side::left : Side::right;
      const HandSkeleton skeleton(side, size);
      const JointAngles made_of = random_angles_within_limits(random);
      const Isometry3d base = random_place(random);
      const auto targets = targets_at(skeleton.pose(made_of, base).fingertip_positions());
      const auto solution = inverse_kinematics(skeleton, base, targets, near(made_of, 0.2, random));
      CAPTURE(round);
      REQUIRE(most(distances(skeleton, base, targets, solution.angles)) < 1e-4);
      REQUIRE(solution.converged);
    }
  }

  TEST_CASE("a left hand of any shape is the mirror image of the right one") {
    std::mt19937 random(32);
    const Vector3d mirror(-1.0, 1.0, 1.0);
    for (int round = 0; round < 100; ++round) {
      HandSize size;
      size.shape = random_shape(random, 0.5);
      const JointAngles angles = random_angles_within_limits(random);
      const auto left = HandSkeleton(Side::left, size).pose(angles, Isometry3d::Identity());
      const auto right = HandSkeleton(Side::right, size).pose(angles, Isometry3d::Identity());
      for (std::size_t at = 0; at < joint_count; ++at) {
        const Vector3d image = mirror.cwiseProduct(right.joints[at].translation());
        REQUIRE((left.joints[at].translation() - image).norm() < 1e-14);
        const Eigen::Matrix3d turn =
            mirror.asDiagonal() * right.joints[at].linear() * mirror.asDiagonal();
        REQUIRE((left.joints[at].linear() - turn).norm() < 1e-13);
      }
    }
  }

  TEST_CASE("each term does what its name says") {
    const auto pose_with = [](ShapeTerm term, double value, const JointAngles& angles) {
      HandSize size;
      size.shape[term] = value;
      return HandSkeleton(Side::right, size).pose(angles, Isometry3d::Identity());
    };
    const JointAngles flat;
    const auto average = HandSkeleton(Side::right).pose(flat, Isometry3d::Identity());
    const auto bone = [](const HandPose& pose, Joint joint) {
      const auto next = static_cast<Joint>(index_of(joint) + 1);
      return (pose[next].translation() - pose[joint].translation()).norm();
    };
    const auto longer = pose_with(ShapeTerm::ring_intermediate, std::log(1.1), flat);
    CHECK(bone(longer, Joint::ring_intermediate) ==
          doctest::Approx(1.1 * bone(average, Joint::ring_intermediate)));
    CHECK(bone(longer, Joint::ring_distal) == doctest::Approx(bone(average, Joint::ring_distal)));
    const auto moved = pose_with(ShapeTerm::thumb_base_y, 0.005, flat);
    CHECK((moved[Joint::thumb_tip].translation() - average[Joint::thumb_tip].translation() -
           Vector3d(0.0, 0.005, 0.0))
              .norm() < 1e-15);
    HandSize padded;
    padded.shape[ShapeTerm::pad_depth] = 0.002;
    padded.shape[ShapeTerm::pad_behind] = -0.001;
    CHECK(HandSkeleton(Side::left, padded)
              .pad()
              .isApprox(Vector3d(0.0, -pad_depth_m - 0.002, pad_behind_tip_m - 0.001)));
    JointAngles bent;
    bent[Finger::index].mcp_flexion_rad = 1.2;
    const double straight_x =
        pose_with(ShapeTerm::index_tilt, 0.0, bent)[Joint::index_tip].translation().x();
    CHECK(pose_with(ShapeTerm::index_tilt, 0.2, bent)[Joint::index_tip].translation().x() >
          straight_x + 0.005); // the ulna is at +X
    CHECK((pose_with(ShapeTerm::index_tilt, 0.2, flat)[Joint::index_tip].translation() -
           average[Joint::index_tip].translation())
              .norm() < 1e-15);
  }

  TEST_CASE("a thumb that turns more as it opposes is, in each pose, one that is turned more") {
    for (const double roll_rad : {-0.2, 0.0, 0.7, 1.3}) {
      for (const double abduction_rad : {0.0, 0.8}) {
        JointAngles angles;
        angles.thumb_roll_rad = roll_rad;
        angles.thumb_abduction_rad = abduction_rad;
        angles.thumb_mcp_flexion_rad = 0.6;
        HandSize changing, constant;
        changing.shape[ShapeTerm::thumb_pronation_by_roll] = -0.3;
        changing.shape[ShapeTerm::thumb_pronation_by_abduction] = 0.2;
        constant.shape[ShapeTerm::thumb_pronation] = -0.3 * roll_rad + 0.2 * abduction_rad;
        const auto at = [&](const HandSize& size) {
          return HandSkeleton(Side::right, size).pose(angles, Isometry3d::Identity());
        };
        CHECK(at(changing)[Joint::thumb_tip].isApprox(at(constant)[Joint::thumb_tip], 1e-12));
      }
    }
  }

  TEST_CASE("touches of another hand teach its shape, and pull angles less than a hand taken for "
            "granted would") {
    // A longer thumb, with another base: its pinches do not fit an average hand.
    HandSize other;
    other.shape[ShapeTerm::thumb_proximal] = 0.10;
    other.shape[ShapeTerm::thumb_base_x] = 0.004;
    other.shape[ShapeTerm::thumb_pronation] = 0.15;
    const HandSkeleton skeleton(Side::right, other);
    const Calibration truth = some_truth(33);
    std::mt19937 random(34);
    std::vector<PoseReading> readings, without_touches;
    for (const PoseId id : full_poses()) {
      const bool touch = pose_of(id).touch.has_value();
      readings.push_back({id, held(touch ? touching(id, skeleton) : exact(id, random), truth)});
      if (!touch) without_touches.push_back(readings.back());
    }
    const auto fit = fit_calibration(readings, Side::right, sensors_22);
    REQUIRE(fit);
    CHECK(fit->touch_residual_m < 0.003);
    CHECK(fit->size.shape[ShapeTerm::thumb_proximal] + fit->size.shape[ShapeTerm::thumb_distal] +
              fit->size.shape[ShapeTerm::thumb_metacarpal] >
          0.0);
    // Poses held exactly determine the angles; the touches must not take them away.
    CHECK(largest_difference_rad(fit->calibration, truth, without_touches) < 7.0 * rad);
  }

  TEST_CASE("a thumb that cannot roll is no reason to refuse, and its pose is named") {
    const Calibration truth = some_truth(35);
    auto readings = exact_readings(truth);
    for (PoseReading& reading : readings) // it points backwards where it should point up
      if (reading.pose == PoseId::thumb_up) reading.held.mean_counts[roll] = 25.0;
    const auto fit = fit_calibration(readings, Side::right, sensors_22);
    REQUIRE(fit);
    const bool named =
        std::any_of(fit->outliers.begin(), fit->outliers.end(), [&](const Outlier& outlier) {
          return outlier.sensor == Sensor::thumb_roll &&
                 readings[outlier.reading].pose == PoseId::thumb_up;
        });
    CHECK(named);
    // All other sensors are as they would be without that pose's roll.
    for (std::size_t slot = 4; slot < sensor_slots; ++slot) {
      if (truth.sensors[slot].gain_rad_per_count == 0.0) continue;
      CHECK(fit->calibration.sensors[slot].gain_rad_per_count ==
            doctest::Approx(truth.sensors[slot].gain_rad_per_count).epsilon(0.12));
    }
  }
}

} // namespace wearer_shape_test
