// Hands in ROS's names, frames and axes, against their poses on the stage.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include <nendo/hand/joint_limits.hpp>
#include <nendo/hand/skeleton.hpp>

#include "ros/hand_messages.hpp"

namespace hand_messages_test {

using namespace nendo;

namespace {

struct PosedHand {
  hand::JointAngles angles;
  hand::HandPose pose;
  ros::HandState state;
};

PosedHand any_hand(Side side, std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  PosedHand made;
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    made.angles[hand::angle_at(at)] = any(random);
  Eigen::Isometry3d forearm = Eigen::Isometry3d::Identity();
  forearm.translation() = Eigen::Vector3d(any(random), any(random), any(random));
  forearm.linear() = Eigen::Quaterniond(any(random), any(random), any(random), any(random))
                         .normalized()
                         .toRotationMatrix();
  made.pose = hand::HandSkeleton(side).pose(made.angles, forearm);
  const auto pose_of = [](const Eigen::Isometry3d& pose) {
    return ros::StagePose{pose.translation(), Eigen::Quaterniond(pose.linear())};
  };
  made.state.side = side;
  made.state.forearm = pose_of(forearm);
  for (std::size_t at = 0; at < hand::joint_count; ++at)
    made.state.joints[at] = pose_of(made.pose.joints[at]);
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    made.state.angles_rad[at] = made.angles[hand::angle_at(at)];
  return made;
}

/// From the stage's axes (x right, y up, z back) to those of REP-103 (x ahead, y left, z up).
Eigen::Matrix3d to_ros() {
  Eigen::Matrix3d turn;
  turn << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  return turn;
}

Eigen::Isometry3d isometry_of(const ros::Vector3& place, const ros::Quaternion& turn) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(place.x, place.y, place.z);
  pose.linear() = Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z).toRotationMatrix();
  return pose;
}

/// The frame's pose in the root of its tree, as tf2 looks it up.
Eigen::Isometry3d looked_up(const ros::TFMessage& message, const std::string& frame,
                            const std::string& root) {
  if (frame == root) return Eigen::Isometry3d::Identity();
  const auto found =
      std::ranges::find(message.transforms, frame, &ros::TransformStamped::child_frame_id);
  REQUIRE(found != message.transforms.end());
  return looked_up(message, found->header.frame_id, root) *
         isometry_of(found->transform.translation, found->transform.rotation);
}

} // namespace

TEST_CASE("each joint's frame is where the joint is, in the axes of REP-103") {
  std::mt19937 random(1);
  const ros::HandMessages messages;
  ros::TFMessage tf;
  for (int round = 0; round < 50; ++round) {
    const PosedHand both[] = {any_hand(Side::left, random), any_hand(Side::right, random)};
    const ros::HandState states[] = {both[0].state, both[1].state};
    messages.transforms(states, 0, tf);
    REQUIRE(tf.transforms.size() == 2 * 27);
    for (const PosedHand& hand : both) {
      for (std::size_t at = 0; at < hand::joint_count; ++at) {
        const std::string name = std::string(name_of(hand.state.side)) + "_" +
                                 std::string(hand::name_of(static_cast<hand::Joint>(at)));
        const Eigen::Isometry3d found = looked_up(tf, name, "stage");
        const Eigen::Isometry3d& own = hand.pose.joints[at];
        INFO(name);
        CHECK((found.translation() - to_ros() * own.translation()).norm() < 1e-13);
        CHECK((found.linear() - to_ros() * own.linear() * to_ros().transpose()).norm() < 1e-13);
      }
    }
  }
}

TEST_CASE("each frame has one parent, and the frames are one tree below the stage") {
  std::mt19937 random(2);
  const ros::HandState states[] = {any_hand(Side::left, random).state,
                                   any_hand(Side::right, random).state};
  ros::TFMessage tf;
  ros::HandMessages("robot/").transforms(states, 0, tf);
  std::map<std::string, int> parents;
  for (const auto& one : tf.transforms)
    ++parents[one.child_frame_id];
  CHECK(parents.size() == tf.transforms.size());
  CHECK(parents.count("robot/left_forearm") == 1);
  CHECK(parents.count("robot/right_little_tip") == 1);
  CHECK(parents.count("robot/stage") == 0);
  for (const auto& [frame, count] : parents)
    looked_up(tf, frame, "robot/stage"); // requires that it is found
}

TEST_CASE("the poses of the joints are those of their frames") {
  std::mt19937 random(3);
  const ros::HandMessages messages;
  const PosedHand hand = any_hand(Side::right, random);
  ros::TFMessage tf;
  ros::PoseArray poses;
  messages.transforms({&hand.state, 1}, 3'000'000'004, tf);
  messages.poses(hand.state, 3'000'000'004, poses);
  CHECK(poses.header.frame_id == "stage");
  CHECK(poses.header.stamp == ros::Time{3, 4});
  CHECK(tf.transforms.back().header.stamp == ros::Time{3, 4});
  REQUIRE(poses.poses.size() == 26);
  for (std::size_t at = 0; at < hand::joint_count; ++at) {
    const auto frame =
        looked_up(tf, "right_" + std::string(hand::name_of(static_cast<hand::Joint>(at))), "stage");
    const auto pose = isometry_of(poses.poses[at].position, poses.poses[at].orientation);
    CHECK((frame.matrix() - pose.matrix()).norm() < 1e-13);
  }
}

TEST_CASE("in the frame stage_y_up, positions are those of the stage") {
  const auto fixed = ros::HandMessages().static_transforms(5);
  REQUIRE(fixed.transforms.size() == 1);
  CHECK(fixed.transforms[0].header.frame_id == "stage");
  CHECK(fixed.transforms[0].child_frame_id == "stage_y_up");
  const auto pose = isometry_of(fixed.transforms[0].transform.translation,
                                fixed.transforms[0].transform.rotation);
  CHECK((pose.matrix().topLeftCorner<3, 3>() - to_ros()).norm() < 1e-15);
  CHECK(pose.translation().norm() == 0.0);
}

TEST_CASE("a flat hand points ahead, its back is up, and the right thumb is on the left") {
  ros::HandState state;
  state.side = Side::right;
  const hand::HandPose flat =
      hand::HandSkeleton(Side::right).pose({}, Eigen::Isometry3d::Identity());
  for (std::size_t at = 0; at < hand::joint_count; ++at)
    state.joints[at] = {flat.joints[at].translation(),
                        Eigen::Quaterniond(flat.joints[at].linear())};
  ros::PoseArray poses;
  ros::HandMessages().poses(state, 0, poses);
  const auto& tip = poses.poses[hand::index_of(hand::Joint::middle_tip)];
  const auto& thumb = poses.poses[hand::index_of(hand::Joint::thumb_tip)];
  CHECK(tip.position.x > 0.1);
  CHECK(thumb.position.y > 0.02);
  const Eigen::Vector3d ahead = isometry_of({}, tip.orientation) * Eigen::Vector3d::UnitX();
  CHECK(ahead.x() > 0.99);
}

TEST_CASE("joint states have the measured angles in radians, and nothing else") {
  std::mt19937 random(4);
  const ros::HandMessages messages;
  ros::HandState states[] = {any_hand(Side::left, random).state,
                             any_hand(Side::right, random).state};
  ros::JointState out;
  for (int round = 0; round < 50; ++round) {
    for (auto& state : states)
      state.measured = static_cast<std::uint32_t>(random()) & 0x7FFFFFU;
    messages.joint_states(states, 1'000'000'002, out);
    CHECK(out.header.stamp == ros::Time{1, 2});
    REQUIRE(out.name.size() == out.position.size());
    CHECK(out.velocity.empty());
    CHECK(out.effort.empty());
    std::map<std::string, double> expected;
    for (const auto& state : states)
      for (std::size_t at = 0; at < hand::angle_count; ++at)
        if ((state.measured & 1U << at) != 0)
          expected[std::string(name_of(state.side)) + "_" + std::string(hand::angle_names[at])] =
              state.angles_rad[at];
    std::map<std::string, double> found;
    for (std::size_t at = 0; at < out.name.size(); ++at)
      found[out.name[at]] = out.position[at];
    CHECK(found == expected);
    CHECK(found.size() == out.name.size());
  }
}

TEST_CASE("a message keeps nothing of the previous one") {
  std::mt19937 random(5);
  const ros::HandMessages messages;
  ros::HandState states[] = {any_hand(Side::left, random).state,
                             any_hand(Side::right, random).state};
  states[0].measured = states[1].measured = 0x7FFFFFU;
  ros::JointState joints;
  ros::TFMessage tf;
  messages.joint_states(states, 1, joints);
  messages.transforms(states, 1, tf);
  CHECK(joints.name.size() == 46);
  messages.joint_states({&states[1], 1}, 1, joints);
  messages.transforms({&states[1], 1}, 1, tf);
  CHECK(joints.name.size() == 23);
  CHECK(std::ranges::all_of(joints.name, [](auto& name) { return name.starts_with("right_"); }));
  CHECK(tf.transforms.size() == 27);
  messages.joint_states({}, 1, joints);
  messages.transforms({}, 1, tf);
  CHECK(joints.name.empty());
  CHECK(joints.position.empty());
  CHECK(tf.transforms.empty());
}

TEST_CASE("a time is the nearest that a stamp can hold") {
  CHECK(ros::time_of(0) == ros::Time{0, 0});
  CHECK(ros::time_of(1'999'999'999) == ros::Time{1, 999'999'999});
  CHECK(ros::time_of(-1) == ros::Time{0, 0});
  CHECK(ros::time_of(std::numeric_limits<std::int64_t>::min()) == ros::Time{0, 0});
  CHECK(ros::time_of(std::numeric_limits<std::int64_t>::max()) ==
        ros::Time{2'147'483'647, 999'999'999});
}

} // namespace hand_messages_test
