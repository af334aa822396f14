#include <nendo/hand/bvh_file.hpp>

#include <limits>
#include <set>

#include <doctest/doctest.h>

#include "support/bvh_reader.hpp"
#include "support/random_poses.hpp"

namespace bvh_test {

using namespace nendo;
using namespace nendo::hand;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using nendo::test::BvhRecording;
using nendo::test::random_angles;
using nendo::test::random_place;

namespace {

constexpr double metres_per_unit = 0.01; // the header says centimetres

std::string name_in_file(Joint joint, Side side) {
  return std::string(name_of(joint)) + (side == Side::left ? "_L" : "_R");
}

bool is_tip(Joint joint) {
  return name_of(joint).ends_with("_tip");
}

std::size_t node_of(const BvhRecording& recording, Joint joint, Side side) {
  return is_tip(joint) ? recording.find_end_of(name_in_file(*parent_of(joint), side))
                       : recording.find(name_in_file(joint, side));
}

template <class Do>
void for_each_joint_but_palm(Do&& act) {
  for (std::size_t at = 0; at < joint_count; ++at)
    if (static_cast<Joint>(at) != Joint::palm) act(static_cast<Joint>(at));
}

BvhRecording written(const HandSkeleton& skeleton, const std::vector<HandPose>& poses,
                     double rate_hz = 90.0) {
  const BvhFormat format(skeleton);
  std::string text = format.hierarchy() + BvhFormat::motion_head(poses.size(), rate_hz);
  for (const auto& pose : poses)
    REQUIRE(format.append_frame(pose, text));
  return BvhRecording(text);
}

} // namespace

TEST_SUITE("bvh") {
  TEST_CASE("another reader's kinematics puts every joint where the skeleton has it, to 1e-6 m") {
    std::mt19937 random(1);
    double worst_m = 0.0;
    double worst_turn = 0.0;
    for (const Side side : {Side::left, Side::right}) {
      const HandSkeleton skeleton(side, {0.2, 0.09});
      const HandPose flat = skeleton.pose({}, Isometry3d::Identity());
      std::vector<HandPose> poses;
      for (int round = 0; round < 300; ++round)
        poses.push_back(skeleton.pose(random_angles(random), random_place(random)));
      const BvhRecording recording = written(skeleton, poses);
      REQUIRE(recording.nodes.size() == joint_count - 1);
      REQUIRE(recording.frames.size() == poses.size());
      for (std::size_t frame = 0; frame < poses.size(); ++frame) {
        const auto world = recording.world(frame);
        for_each_joint_but_palm([&](Joint joint) {
          const Eigen::Matrix4d& placed = world[node_of(recording, joint, side)];
          const Vector3d at_m = metres_per_unit * placed.topRightCorner<3, 1>();
          worst_m = std::max(worst_m, (at_m - poses[frame][joint].translation()).norm());
          if (is_tip(joint)) return;
          const Matrix3d turned = placed.topLeftCorner<3, 3>() * flat[joint].linear();
          worst_turn = std::max(worst_turn, (turned - poses[frame][joint].linear()).norm());
        });
      }
    }
    MESSAGE("worst place " << worst_m << " m, worst orientation " << worst_turn);
    CHECK(worst_m < 1e-6);
    CHECK(worst_turn < 1e-6);
  }

  TEST_CASE("where two axes fall together the pose is kept, too") {
    for (const double z_rad : {std::acos(0.0), -std::acos(0.0)}) {
      Isometry3d place = Isometry3d::Identity();
      place.linear() =
          (Eigen::AngleAxisd(0.7, Vector3d::UnitY()) * Eigen::AngleAxisd(z_rad, Vector3d::UnitZ()) *
           Eigen::AngleAxisd(-0.4, Vector3d::UnitX()))
              .toRotationMatrix();
      const HandSkeleton skeleton(Side::right);
      const HandPose pose = skeleton.pose({}, place);
      const BvhRecording recording = written(skeleton, {pose});
      const auto world = recording.world(0);
      for_each_joint_but_palm([&](Joint joint) {
        const auto& placed = world[node_of(recording, joint, Side::right)];
        CHECK((metres_per_unit * placed.topRightCorner<3, 1>() - pose[joint].translation()).norm() <
              1e-6);
      });
    }
  }

  TEST_CASE("the hierarchy is the flat hand, and in the flat hand nothing is turned") {
    for (const Side side : {Side::left, Side::right}) {
      const HandSkeleton skeleton(side);
      const HandPose flat = skeleton.pose({}, Isometry3d::Identity());
      const BvhRecording recording = written(skeleton, {flat});
      for_each_joint_but_palm([&](Joint joint) {
        const auto& node = recording.nodes[node_of(recording, joint, side)];
        CHECK(node.channels.size() == (is_tip(joint) ? 0 : joint == Joint::wrist ? 6 : 3));
        const auto parent = parent_of(joint);
        if (!parent) return;
        CHECK(node.parent == static_cast<int>(node_of(recording, *parent, side)));
        const Vector3d bone = flat[joint].translation() - flat[*parent].translation();
        CHECK((metres_per_unit * node.offset - bone).norm() < 1e-7);
      });
      for (const double value : recording.frames[0])
        CHECK(value == 0.0);
      // The thumb is on the left of a right hand.
      const auto& thumb = recording.nodes[node_of(recording, Joint::thumb_metacarpal, side)];
      CHECK((thumb.offset.x() < 0.0) == (side == Side::right));
    }
  }

  TEST_CASE("a finger's channels are its joints' angles, in degrees") {
    JointAngles angles;
    angles[Finger::ring] = {1.9, -0.3, 1.6, 0.5}; // beyond a right angle
    const HandSkeleton skeleton(Side::right);
    const auto recording = written(skeleton, {skeleton.pose(angles, Isometry3d::Identity())});
    const auto rad = [&](const std::string& joint, const std::string& channel) {
      return recording.channel(0, joint, channel) * std::acos(-1.0) / 180.0;
    };
    CHECK(rad("ring_proximal_R", "Yrotation") == doctest::Approx(-0.3));
    CHECK(rad("ring_proximal_R", "Zrotation") == 0.0);
    CHECK(rad("ring_proximal_R", "Xrotation") == doctest::Approx(-1.9));
    CHECK(rad("ring_intermediate_R", "Xrotation") == doctest::Approx(-1.6));
    CHECK(rad("ring_distal_R", "Xrotation") == doctest::Approx(-0.5));
    CHECK(rad("middle_proximal_R", "Xrotation") == 0.0);
  }

  TEST_CASE("the frame time is the rate's to a picosecond, and the count has space to grow") {
    const BvhRecording recording = written(HandSkeleton(Side::left), {}, 90.0);
    CHECK(std::abs(recording.frame_time_s - 1.0 / 90.0) < 1e-12);
    const auto head = [](std::uint64_t frames) { return BvhFormat::motion_head(frames, 90.0); };
    CHECK(head(0).size() == head(999'999'999'999).size());
    CHECK(head(7).substr(BvhFormat::count_place).starts_with(BvhFormat::count_text(7) + "\n"));
  }

  TEST_CASE("a pose that is not finite is refused whole") {
    const HandSkeleton skeleton(Side::right);
    const BvhFormat format(skeleton);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e308}) {
      HandPose pose = skeleton.pose({}, Isometry3d::Identity());
      pose.joints[index_of(Joint::wrist)].translation().x() = bad;
      std::string text = "before\n";
      CHECK_FALSE(format.append_frame(pose, text));
      CHECK(text == "before\n");
    }
    HandPose pose = skeleton.pose({}, Isometry3d::Identity());
    pose.joints[index_of(Joint::ring_distal)].linear()(1, 1) =
        std::numeric_limits<double>::quiet_NaN();
    std::string text;
    CHECK_FALSE(format.append_frame(pose, text));
    CHECK(text.empty());
  }

  TEST_CASE("absurd but finite places stay numbers") {
    const HandSkeleton skeleton(Side::right);
    Isometry3d far = Isometry3d::Identity();
    far.translation() = Vector3d(1e300, -1e300, 1e-300);
    const auto recording = written(skeleton, {skeleton.pose({}, far)});
    CHECK(recording.channel(0, "wrist_R", "Xposition") == doctest::Approx(1e302));
  }
}

} // namespace bvh_test
