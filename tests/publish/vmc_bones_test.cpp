// Bones of an avatar, in Unity's axes: x right, y up, z forward, left-handed.

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include <nendo/base/units.hpp>
#include <nendo/hand/skeleton.hpp>

#include "publish/vmc_bones.hpp"
#include "support/random_poses.hpp"

namespace vmc_bones_test {

using namespace nendo;
using namespace nendo::publish;
using hand::Joint;

namespace {

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>; // x y z w

// Unity's Quaternion * Vector3 and Quaternion * Quaternion. Their formulas do not depend on the
// handedness.
Vector turned(const Quaternion& q, const Vector& v) {
  const auto& [x, y, z, w] = q;
  const Vector t{2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])};
  return {v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
          v[2] + w * t[2] + x * t[1] - y * t[0]};
}
Quaternion times(const Quaternion& a, const Quaternion& b) {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

template <std::size_t size>
std::array<double, size> doubles(const std::array<float, size>& floats) {
  std::array<double, size> numbers{};
  std::copy(floats.begin(), floats.end(), numbers.begin());
  return numbers;
}

struct Placed {
  Vector position{};
  Quaternion rotation{0, 0, 0, 1};
};

/// Where an avatar has its bones, whose forearms point to their sides, by name without the side.
std::map<std::string, Placed> placed(Side side, const hand::JointAngles& angles,
                                     const Eigen::Isometry3d& T_stage_wrist) {
  const hand::HandSkeleton skeleton(side);
  const hand::HandPose pose = skeleton.pose(angles, T_stage_wrist);
  const auto published = [](const Eigen::Isometry3d& T) {
    nendo_publish_joint joint{};
    const Eigen::Vector3f place = T.translation().cast<float>();
    const Eigen::Quaternionf turn = Eigen::Quaterniond(T.linear()).cast<float>();
    std::copy_n(place.data(), 3, joint.position);
    std::copy_n(turn.coeffs().data(), 4, joint.orientation);
    return joint;
  };
  nendo_publish_hand hand{};
  for (std::size_t at = 0; at < hand::joint_count; ++at)
    hand.joints[at] = published(pose.joints[at]);
  std::map<std::string, Placed> bones;
  const std::string prefix = side == Side::right ? "Right" : "Left";
  for (const BonePose& bone : VmcHand(skeleton).bones(hand, published(T_stage_wrist))) {
    const std::string whole = bone.name;
    REQUIRE(whole.starts_with(prefix));
    const std::string name = whole.substr(prefix.size());
    // Unity's hierarchy: Hand, then Proximal, Intermediate and Distal of each finger.
    Placed parent;
    for (const auto& [end, above] :
         {std::pair{"Distal", "Intermediate"}, {"Intermediate", "Proximal"}})
      if (name.ends_with(end))
        parent = bones.at(name.substr(0, name.size() - std::string(end).size()) + above);
    if (name.ends_with("Proximal")) parent = bones.at("Hand");
    Placed here;
    const auto offset = turned(parent.rotation, doubles(bone.position_m));
    for (std::size_t axis = 0; axis < 3; ++axis)
      here.position[axis] = parent.position[axis] + offset[axis];
    here.rotation = times(parent.rotation, doubles(bone.rotation_xyzw));
    bones[name] = here;
  }
  return bones;
}

/// Where a bone's end points that pointed to the arm's side in the T-pose.
Vector direction(const Placed& bone, Side side) {
  return turned(bone.rotation, {side == Side::right ? 1.0 : -1.0, 0.0, 0.0});
}

hand::JointAngles fist() {
  hand::JointAngles angles;
  for (auto& finger : angles.fingers)
    finger = {from_degrees(90.0), 0.0, from_degrees(90.0), from_degrees(45.0)};
  return angles;
}

} // namespace

TEST_SUITE("vmc_bones") {
  TEST_CASE("from the wrist to each fingertip, bones are where the hand's joints are") {
    std::mt19937 random(4);
    for (const Side side : {Side::left, Side::right})
      for (int round = 0; round < 20; ++round) {
        const hand::JointAngles angles = test::random_angles(random);
        const Eigen::Isometry3d T_stage_wrist = test::random_place(random);
        const auto bones = placed(side, angles, T_stage_wrist);
        const hand::HandPose pose = hand::HandSkeleton(side).pose(angles, T_stage_wrist);
        const double outwards = side == Side::right ? 1.0 : -1.0;
        // The avatar's forearm points to its side; the wearer's, as its wrist does.
        Eigen::Matrix3d rest;
        rest << 0.0, 0.0, -outwards, 0.0, 1.0, 0.0, outwards, 0.0, 0.0;
        const Eigen::Isometry3d T_wrist_stage = T_stage_wrist.inverse();
        for (const auto& [name, joint] : {std::pair{"IndexDistal", Joint::index_distal},
                                          {"MiddleIntermediate", Joint::middle_intermediate},
                                          {"LittleDistal", Joint::little_distal},
                                          {"ThumbProximal", Joint::thumb_metacarpal},
                                          {"ThumbDistal", Joint::thumb_distal}}) {
          const Eigen::Vector3d expected = rest * ((T_wrist_stage * pose[joint]).translation());
          const Vector& bone = bones.at(name).position;
          const Vector& wrist = bones.at("Hand").position;
          CHECK(bone[0] - wrist[0] == doctest::Approx(expected.x()).epsilon(1e-4));
          CHECK(bone[1] - wrist[1] == doctest::Approx(expected.y()).epsilon(1e-4));
          CHECK(bone[2] - wrist[2] == doctest::Approx(-expected.z()).epsilon(1e-4));
        }
      }
  }

  TEST_CASE("a flat hand rotates no bone of a finger") {
    for (const Side side : {Side::left, Side::right})
      for (const auto& [name, bone] : placed(side, {}, Eigen::Isometry3d::Identity()))
        if (!name.starts_with("Thumb")) CHECK(bone.rotation[3] > 0.97); // within 28 degrees
  }

  TEST_CASE("in a fist the first bones of fingers point down, and the middle ones back") {
    for (const Side side : {Side::left, Side::right}) {
      const auto bones = placed(side, fist(), Eigen::Isometry3d::Identity());
      for (const std::string finger : {"Index", "Middle", "Ring", "Little"}) {
        CAPTURE(finger);
        CHECK(direction(bones.at(finger + "Proximal"), side)[1] < -0.9);
        const double outwards = direction(bones.at(finger + "Intermediate"), side)[0];
        CHECK((side == Side::right ? outwards : -outwards) < -0.9);
      }
    }
  }

  TEST_CASE("an index finger that points, of a fist, points to the side as the arm does") {
    for (const Side side : {Side::left, Side::right}) {
      hand::JointAngles angles = fist();
      angles[hand::Finger::index] = {};
      const auto bones = placed(side, angles, Eigen::Isometry3d::Identity());
      const double outwards = direction(bones.at("IndexDistal"), side)[0];
      CHECK((side == Side::right ? outwards : -outwards) > 0.95);
      CHECK(direction(bones.at("MiddleProximal"), side)[1] < -0.9);
    }
  }

  TEST_CASE("with the palm down, an open thumb points forward, whatever way the arm points") {
    for (const Side side : {Side::left, Side::right}) {
      hand::JointAngles open;
      open.thumb_abduction_rad = from_degrees(50.0);
      const auto flat = placed(side, open, Eigen::Isometry3d::Identity());
      const Vector& wrist = flat.at("Hand").position;
      CHECK(flat.at("ThumbDistal").position[2] - wrist[2] > 0.03);
      // The wrist bent by nothing, the thumb is on the same side whatever way the arm points.
      Eigen::Isometry3d turned_arm = Eigen::Isometry3d::Identity();
      turned_arm.linear() =
          Eigen::AngleAxisd(1.0, Eigen::Vector3d(0.3, 0.8, -0.5).normalized()).toRotationMatrix();
      const auto same = placed(side, open, turned_arm);
      CHECK(same.at("ThumbDistal").position[2] - same.at("Hand").position[2] ==
            doctest::Approx(flat.at("ThumbDistal").position[2] - wrist[2]).epsilon(1e-4));
    }
  }
}

} // namespace vmc_bones_test
