// What a thumb is for. Contact is pad to pad, found by inverse kinematics and judged by forward
// kinematics alone.

#include <array>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/inverse_kinematics.hpp>
#include <nendo/hand/joint_limits.hpp>

namespace opposition_test {

using namespace nendo;
using namespace nendo::hand;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

constexpr double rad = std::numbers::pi / 180.0;
const Isometry3d origin = Isometry3d::Identity();
const Vector3d pad(0.0, -pad_depth_m, pad_behind_tip_m);

struct Contact {
  JointAngles angles;
  double gap_m = 1.0;
};

/// How much the backs of the two tips look the same way: -1 is pulp on pulp, 0 pulp on the tip's
/// end, 1 side by side.
double sideways(const HandPose& pose, std::size_t finger) {
  return pose[Joint::thumb_tip].linear().col(1).dot(pose[fingertips[finger]].linear().col(1));
}

/// Sends both tips to where their pads would meet, again and again, because a tip turns as it
/// moves.
Contact meet(const HandSkeleton& skeleton, std::size_t finger, JointAngles angles) {
  Contact contact;
  for (int turn = 0; turn < 40; ++turn) {
    const HandPose pose = skeleton.pose(angles, origin);
    const Isometry3d& thumb = pose[Joint::thumb_tip];
    const Isometry3d& other = pose[fingertips[finger]];
    contact = {angles, (thumb * pad - other * pad).norm()};
    if (contact.gap_m < 5e-5) break;
    const Vector3d half_gap_m = 0.5 * (other * pad - thumb * pad);
    FingertipTargets targets;
    targets[0] = {thumb.translation() + half_gap_m, 1.0};
    targets[finger] = {other.translation() - half_gap_m, 1.0};
    angles = inverse_kinematics(skeleton, origin, targets, angles).angles;
  }
  return contact;
}

bool within_soft_limits(const JointAngles& angles, double margin_rad) {
  for (std::size_t n = 0; n < angle_count; ++n) {
    const double angle_rad = angles[angle_at(n)];
    if (angle_rad < joint_limits[n].soft_min_rad - margin_rad) return false;
    if (angle_rad > joint_limits[n].soft_max_rad + margin_rad) return false;
  }
  return true;
}

/// Of the contacts in postures that hands take, that in which the pulps face most.
Contact oppose(const HandSkeleton& skeleton, std::size_t finger) {
  const double number = static_cast<double>(finger);
  Contact best;
  double least = 2.0;
  for (const double finger_mcp_deg : {50.0, 70.0, 85.0}) {
    for (const double abduction_deg : {25.0, 40.0, 55.0}) {
      JointAngles angles;
      angles.thumb_roll_rad = (58.0 + 6.0 * number) * rad;
      angles.thumb_abduction_rad = abduction_deg * rad;
      angles.thumb_mcp_flexion_rad = 15.0 * number * rad;
      angles.thumb_ip_flexion_rad = 5.0 * rad;
      angles.fingers[finger - 1] = {finger_mcp_deg * rad, 0.0, (95.0 - finger_mcp_deg) * rad, 0.1};
      const Contact contact = meet(skeleton, finger, angles);
      const double now = sideways(skeleton.pose(contact.angles, origin), finger);
      const bool natural = within_soft_limits(contact.angles, 10.0 * rad) &&
                           contact.angles.fingers[finger - 1].pip_flexion_rad > 0.0;
      if (contact.gap_m > 5e-5 || !natural || now >= least) continue;
      least = now;
      best = contact;
    }
  }
  return best;
}

template <class Judge>
void for_many_hands(Judge&& judge) {
  for (const Side side : {Side::left, Side::right}) {
    for (const double length_m : {0.160, 0.187, 0.215}) {
      for (const double slenderness : {0.40, 0.444, 0.49})
        judge(HandSkeleton(side, {length_m, slenderness * length_m}), length_m);
    }
  }
}

} // namespace

TEST_SUITE("opposition") {
  TEST_CASE("the thumb's pad meets each finger's pad, in a posture that hands take") {
    for_many_hands([](const HandSkeleton& skeleton, double length_m) {
      for (std::size_t finger = 1; finger < finger_count; ++finger) {
        const Contact contact = oppose(skeleton, finger);
        CAPTURE(length_m);
        CAPTURE(finger);
        CHECK(contact.gap_m < 1e-4);
        CHECK(within_soft_limits(contact.angles, 10.0 * rad));
        const FingerAngles& bent = contact.angles.fingers[finger - 1];
        CHECK(bent.mcp_flexion_rad > 0.0);
        CHECK(bent.pip_flexion_rad > 0.0);
        CHECK(sideways(skeleton.pose(contact.angles, origin), finger) < 0.8);
      }
    });
  }

  TEST_CASE("the thumb rolls farther, the farther the finger is") {
    for_many_hands([](const HandSkeleton& skeleton, double) {
      double before_rad = 0.0;
      for (std::size_t finger = 1; finger < finger_count; ++finger) {
        const JointAngles angles = oppose(skeleton, finger).angles;
        const double opposed_rad = angles.thumb_roll_rad + angles.thumb_mcp_flexion_rad;
        CHECK(opposed_rad > before_rad);
        before_rad = opposed_rad;
      }
    });
  }

  TEST_CASE("the thumb's pad lies on the base of the little finger, in front of the palm") {
    for_many_hands([](const HandSkeleton& skeleton, double length_m) {
      JointAngles angles;
      angles.thumb_roll_rad = 45.0 * rad;
      angles.thumb_abduction_rad = 10.0 * rad;
      angles.thumb_mcp_flexion_rad = angles.thumb_ip_flexion_rad = 45.0 * rad;
      double gap_m = 1.0;
      for (int turn = 0; turn < 60; ++turn) {
        const HandPose pose = skeleton.pose(angles, origin);
        // As deep as the flesh of the palm is there.
        const Vector3d skin = pose[Joint::little_proximal] * Vector3d(0, -0.06 * length_m, 0);
        const Vector3d thumb = pose[Joint::thumb_tip] * pad;
        gap_m = (skin - thumb).norm();
        FingertipTargets targets;
        targets[0] = {pose[Joint::thumb_tip].translation() + skin - thumb, 1.0};
        angles = inverse_kinematics(skeleton, origin, targets, angles).angles;
      }
      CAPTURE(length_m);
      CHECK(gap_m < 1e-4);
      CHECK(within_soft_limits(angles, 10.0 * rad));
      CHECK(skeleton.pose(angles, origin)[Joint::thumb_distal].translation().y() < -0.01);
    });
  }

  TEST_CASE("opposing turns the thumb's pad from beside the hand towards the fingers") {
    const HandSkeleton skeleton(Side::right);
    const auto pad_direction = [&](double roll_deg, double abduction_deg) -> Vector3d {
      JointAngles angles;
      angles.thumb_roll_rad = roll_deg * rad;
      angles.thumb_abduction_rad = abduction_deg * rad;
      return -skeleton.pose(angles, origin)[Joint::thumb_metacarpal].linear().col(1);
    };
    // Beside the index finger it faces its side and the palm's front; in opposition, across the
    // palm. It turns about itself by tens of degrees, not by the whole of the roll (Cooney and
    // others 1981: 17 beside 53 of flexion).
    CHECK(pad_direction(0, 0).x() > 0.5);
    CHECK(pad_direction(0, 0).y() < -0.5);
    CHECK(pad_direction(80, 35).x() > 0.9);
    CHECK(pad_direction(80, 35).y() > pad_direction(0, 0).y() + 0.4);
    CHECK(pad_direction(80, 35).z() < 0.05);
  }
}

} // namespace opposition_test
