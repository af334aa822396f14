// The joints are OpenXR's: names, numbers and count against the standard's own header when this is
// compiled, axes against what XR_EXT_hand_tracking says of them ("Conventions of hand joints").
// Only the header is used: no loader, no runtime.

#include <algorithm>
#include <cctype>
#include <random>
#include <string>

#include <doctest/doctest.h>
#include <openxr/openxr.h>
#include <openxr/openxr_reflection.h>

#include <nendo/hand/skeleton.hpp>

#include "support/random_poses.hpp"

namespace openxr_test {

using namespace nendo;
using namespace nendo::hand;
using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

constexpr bool same(Joint ours, XrHandJointEXT theirs) {
  return static_cast<int>(ours) == static_cast<int>(theirs);
}

static_assert(joint_count == XR_HAND_JOINT_COUNT_EXT);
static_assert(same(Joint::palm, XR_HAND_JOINT_PALM_EXT));
static_assert(same(Joint::wrist, XR_HAND_JOINT_WRIST_EXT));
static_assert(same(Joint::thumb_metacarpal, XR_HAND_JOINT_THUMB_METACARPAL_EXT));
static_assert(same(Joint::thumb_proximal, XR_HAND_JOINT_THUMB_PROXIMAL_EXT));
static_assert(same(Joint::thumb_distal, XR_HAND_JOINT_THUMB_DISTAL_EXT));
static_assert(same(Joint::thumb_tip, XR_HAND_JOINT_THUMB_TIP_EXT));
static_assert(same(Joint::index_metacarpal, XR_HAND_JOINT_INDEX_METACARPAL_EXT));
static_assert(same(Joint::index_proximal, XR_HAND_JOINT_INDEX_PROXIMAL_EXT));
static_assert(same(Joint::index_intermediate, XR_HAND_JOINT_INDEX_INTERMEDIATE_EXT));
static_assert(same(Joint::index_distal, XR_HAND_JOINT_INDEX_DISTAL_EXT));
static_assert(same(Joint::index_tip, XR_HAND_JOINT_INDEX_TIP_EXT));
static_assert(same(Joint::middle_metacarpal, XR_HAND_JOINT_MIDDLE_METACARPAL_EXT));
static_assert(same(Joint::middle_proximal, XR_HAND_JOINT_MIDDLE_PROXIMAL_EXT));
static_assert(same(Joint::middle_intermediate, XR_HAND_JOINT_MIDDLE_INTERMEDIATE_EXT));
static_assert(same(Joint::middle_distal, XR_HAND_JOINT_MIDDLE_DISTAL_EXT));
static_assert(same(Joint::middle_tip, XR_HAND_JOINT_MIDDLE_TIP_EXT));
static_assert(same(Joint::ring_metacarpal, XR_HAND_JOINT_RING_METACARPAL_EXT));
static_assert(same(Joint::ring_proximal, XR_HAND_JOINT_RING_PROXIMAL_EXT));
static_assert(same(Joint::ring_intermediate, XR_HAND_JOINT_RING_INTERMEDIATE_EXT));
static_assert(same(Joint::ring_distal, XR_HAND_JOINT_RING_DISTAL_EXT));
static_assert(same(Joint::ring_tip, XR_HAND_JOINT_RING_TIP_EXT));
static_assert(same(Joint::little_metacarpal, XR_HAND_JOINT_LITTLE_METACARPAL_EXT));
static_assert(same(Joint::little_proximal, XR_HAND_JOINT_LITTLE_PROXIMAL_EXT));
static_assert(same(Joint::little_intermediate, XR_HAND_JOINT_LITTLE_INTERMEDIATE_EXT));
static_assert(same(Joint::little_distal, XR_HAND_JOINT_LITTLE_DISTAL_EXT));
static_assert(same(Joint::little_tip, XR_HAND_JOINT_LITTLE_TIP_EXT));

// XR_HAND_JOINT_THUMB_TIP_EXT is thumb_tip.
std::string our_name_for(std::string theirs) {
  theirs = theirs.substr(std::string("XR_HAND_JOINT_").size());
  theirs.resize(theirs.size() - std::string("_EXT").size());
  std::transform(theirs.begin(), theirs.end(), theirs.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return theirs;
}

Vector3d x_of(const Isometry3d& pose) {
  return pose.linear().col(0);
}
Vector3d y_of(const Isometry3d& pose) {
  return pose.linear().col(1);
}
Vector3d forward(const Isometry3d& pose) { // -Z
  return -pose.linear().col(2);
}

Vector3d from_to(const HandPose& pose, Joint from, Joint to) {
  return (pose[to].translation() - pose[from].translation()).normalized();
}

// Out of the back of the hand, from where its joints are: the thumb lies on one side of a flat
// hand, so the middle finger's direction and the direction to the thumb's side span the palm, and
// which of the plane's two normals is dorsal follows from the side.
Vector3d dorsal(const HandPose& flat, Side side) {
  const Vector3d forwards = from_to(flat, Joint::wrist, Joint::middle_proximal);
  const Vector3d to_thumb = from_to(flat, Joint::little_proximal, Joint::index_proximal);
  const Vector3d normal = to_thumb.cross(forwards).normalized();
  // A right hand seen from behind, fingers up, has its thumb on the left: to_thumb is -X and
  // forwards +Y of the picture, so their product points away from the eye, into the hand.
  return side == Side::right ? Vector3d(-normal) : normal;
}

/// Those at the base of a phalanx or of the thumb's metacarpal or a finger's.
template <class Do>
void for_each_bone(Do&& act) {
  for (std::size_t at = index_of(Joint::thumb_metacarpal); at + 1 < joint_count; ++at) {
    const auto base = static_cast<Joint>(at);
    const auto end = static_cast<Joint>(at + 1);
    if (parent_of(end) == base) act(base, end);
  }
}

template <class Law>
void in_random_poses(Law&& law) {
  std::mt19937 random(11);
  for (const Side side : {Side::left, Side::right}) {
    const HandSkeleton skeleton(side);
    for (int round = 0; round < 50; ++round)
      law(skeleton.pose(test::random_angles(random), test::random_place(random)));
  }
}

constexpr double cos_10_degrees = 0.9848;

} // namespace

TEST_SUITE("openxr") {
  TEST_CASE("each joint has the name that OpenXR gives its number") {
    std::size_t seen = 0;
#define CHECK_NAME(their_name, number)                                                             \
  if (number < XR_HAND_JOINT_COUNT_EXT) {                                                          \
    CHECK(our_name_for(#their_name) == name_of(static_cast<Joint>(number)));                       \
    ++seen;                                                                                        \
  }
    XR_LIST_ENUM_XrHandJointEXT(CHECK_NAME);
#undef CHECK_NAME
    CHECK(seen == joint_count);
  }

  TEST_CASE("-Z points along the bone to the tip, a tip's as its bone's, in any pose") {
    in_random_poses([](const HandPose& pose) {
      for_each_bone([&](Joint base, Joint end) {
        CAPTURE(name_of(base));
        CHECK((forward(pose[base]) - from_to(pose, base, end)).norm() < 1e-9);
        if (std::find(fingertips.begin(), fingertips.end(), end) != fingertips.end())
          CHECK((forward(pose[end]) - from_to(pose, base, end)).norm() < 1e-9);
      });
    });
  }

  TEST_CASE("the axes are a right-handed frame, X = Y x Z, in any pose of either hand") {
    in_random_poses([](const HandPose& pose) {
      for (const Isometry3d& joint : pose.joints) {
        CHECK((y_of(joint).cross(-forward(joint)) - x_of(joint)).norm() < 1e-9);
        CHECK((joint.linear() * joint.linear().transpose() - Eigen::Matrix3d::Identity()).norm() <
              1e-9);
      }
    });
  }

  TEST_CASE("in the open hand +Y comes out of the back of hand and fingers, +X points right") {
    for (const Side side : {Side::left, Side::right}) {
      const HandPose flat = HandSkeleton(side).pose({}, Isometry3d::Identity());
      const Vector3d back = dorsal(flat, side);
      const Vector3d forwards = from_to(flat, Joint::wrist, Joint::middle_proximal);
      const Vector3d across = from_to(flat, Joint::little_proximal, Joint::index_proximal);
      const Vector3d to_thumb = (across - across.dot(forwards) * forwards).normalized();
      // Seen from behind, the thumb of a right hand is on the left, of a left hand on the right.
      const Vector3d right = side == Side::right ? Vector3d(-to_thumb) : to_thumb;
      for (std::size_t at = 0; at < joint_count; ++at) {
        const auto joint = static_cast<Joint>(at);
        if (name_of(joint).starts_with("thumb")) continue; // its nail looks elsewhere
        CAPTURE(name_of(joint));
        CHECK(y_of(flat[joint]).dot(back) > cos_10_degrees);
        CHECK(x_of(flat[joint]).dot(right) > 0.9); // the metacarpals fan out
      }
      // The thumb's nail looks to the thumb's side, and not into the palm.
      for (const Joint joint : {Joint::thumb_metacarpal, Joint::thumb_proximal, Joint::thumb_distal,
                                Joint::thumb_tip}) {
        CHECK(y_of(flat[joint]).dot(to_thumb) > 0.5);
        CHECK(y_of(flat[joint]).dot(back) > 0.0);
      }
    }
  }

  TEST_CASE("a joint that bends turns about its X, away from its nail") {
    const auto check = [](Side side, Joint hinge, auto&& bend) {
      JointAngles angles;
      const HandSkeleton skeleton(side);
      const HandPose before = skeleton.pose(angles, Isometry3d::Identity());
      bend(angles);
      const HandPose after = skeleton.pose(angles, Isometry3d::Identity());
      const auto end = static_cast<Joint>(index_of(hinge) + 1);
      const Vector3d moved = (after[end].translation() - before[end].translation()).normalized();
      CAPTURE(name_of(side));
      CAPTURE(name_of(hinge));
      CHECK(moved.dot(-y_of(before[hinge])) > 0.99);
      CHECK((x_of(after[hinge]) - x_of(before[hinge])).norm() < 1e-9);
    };
    constexpr double little_rad = 0.05;
    for (const Side side : {Side::left, Side::right}) {
      check(side, Joint::thumb_proximal,
            [](JointAngles& a) { a.thumb_mcp_flexion_rad = little_rad; });
      check(side, Joint::thumb_distal, [](JointAngles& a) { a.thumb_ip_flexion_rad = little_rad; });
      for (const Finger finger : {Finger::index, Finger::middle, Finger::ring, Finger::little}) {
        const auto tip = index_of(fingertips[static_cast<std::size_t>(finger)]);
        check(side, static_cast<Joint>(tip - 3),
              [&](JointAngles& a) { a[finger].mcp_flexion_rad = little_rad; });
        check(side, static_cast<Joint>(tip - 2),
              [&](JointAngles& a) { a[finger].pip_flexion_rad = little_rad; });
        check(side, static_cast<Joint>(tip - 1),
              [&](JointAngles& a) { a[finger].dip_flexion_rad = little_rad; });
      }
    }
  }

  TEST_CASE("wrist and palm look along the middle finger's metacarpal, in any pose") {
    in_random_poses([](const HandPose& pose) {
      CHECK((forward(pose[Joint::wrist]) - from_to(pose, Joint::wrist, Joint::middle_metacarpal))
                .norm() < 1e-9);
      CHECK((forward(pose[Joint::palm]) -
             from_to(pose, Joint::middle_metacarpal, Joint::middle_proximal))
                .norm() < 1e-9);
      const Vector3d centre = 0.5 * (pose[Joint::middle_metacarpal].translation() +
                                     pose[Joint::middle_proximal].translation());
      CHECK((pose[Joint::palm].translation() - centre).norm() < 1e-12);
    });
  }
}

} // namespace openxr_test
