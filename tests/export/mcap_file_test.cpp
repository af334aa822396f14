// Takes as recordings for ROS 2, against the frames that they are made of.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/angle_sources.hpp>

#include "export/mcap_file.hpp"
#include "support/mcap_reader.hpp"
#include "support/recorded_motion.hpp"
#include "support/ros2msg.hpp"
#include "support/scripted_frames.hpp"
#include "takes/tape_commands.hpp"

namespace mcap_file_test {

using namespace nendo;
using namespace nendo::exporting;
using nendo::test::Mcap;
using nendo::test::Motion;
using nendo::test::RecordedMotion;
using Leaf = test::Ros2Schema::Leaf;

namespace {

constexpr std::int64_t begun_ns = 1'750'000'000'123'456'789;

Mcap exported(takes::FrameSource& source, const std::filesystem::path& path,
              std::span<const timeline::Event> commands = {}, const Choice& choice = {}) {
  auto frames = ChosenFrames::make(source, choice);
  REQUIRE(frames);
  const auto done = export_mcap(*frames, commands, {begun_ns, "a test"}, path);
  REQUIRE(done);
  CHECK(done->bytes == std::filesystem::file_size(path));
  return Mcap::indexed(test::file_bytes(path));
}

std::vector<Leaf> decoded(const Mcap& mcap, const Mcap::Message& message) {
  for (const auto& [id, channel] : mcap.channels)
    if (channel.topic == message.topic)
      return test::Ros2Schema(channel.schema_name, channel.schema)
          .decode(std::as_bytes(std::span(message.data)));
  throw std::runtime_error("no channel");
}

std::vector<Mcap::Message> on_topic(const Mcap& mcap, const std::string& topic) {
  std::vector<Mcap::Message> found;
  std::ranges::copy_if(mcap.messages, std::back_inserter(found),
                       [&](const auto& message) { return message.topic == topic; });
  return found;
}

/// The joints of a message and their angles.
std::map<std::string, double> joints_of(const std::vector<Leaf>& leaves) {
  std::vector<std::string> names;
  std::vector<double> angles;
  for (const Leaf& leaf : leaves) {
    if (leaf.path.starts_with("name[")) names.push_back(leaf.text);
    if (leaf.path.starts_with("position[")) angles.push_back(leaf.number);
  }
  REQUIRE(names.size() == angles.size());
  std::map<std::string, double> joints;
  for (std::size_t at = 0; at < names.size(); ++at)
    joints[names[at]] = angles[at];
  CHECK(joints.size() == names.size());
  return joints;
}

/// The angles of a frame that sensors measure, by the names of their joints.
std::map<std::string, double> measured_in(const flow::Frame& frame) {
  std::map<std::string, double> joints;
  for (const Side side : {Side::left, Side::right}) {
    const flow::HandFrame& hand = frame.hands[flow::Placement::index_of(side)];
    const auto sources = hand::angle_sources(hand.sensors, hand.left_out);
    for (std::size_t at = 0; at < hand::angle_count; ++at)
      if (sources[at] == hand::AngleSource::measured)
        joints[std::string(name_of(side)) + "_" + std::string(hand::angle_names[at])] =
            hand.angles[hand::angle_at(at)];
  }
  return joints;
}

std::uint64_t stamp_of(const std::vector<Leaf>& leaves) {
  return static_cast<std::uint64_t>(leaves[0].number) * 1'000'000'000 +
         static_cast<std::uint64_t>(leaves[1].number);
}

/// The position of a frame in `stage`, by the transforms of a message.
Eigen::Isometry3d looked_up(const std::vector<Leaf>& leaves, const std::string& frame) {
  if (frame == "stage") return Eigen::Isometry3d::Identity();
  constexpr std::size_t per_transform = 11; // stamp, two names, three numbers, four numbers
  for (std::size_t at = 0; at < leaves.size(); at += per_transform) {
    const Leaf* const leaf = &leaves[at];
    if (leaf[3].text != frame) continue;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Eigen::Vector3d(leaf[4].number, leaf[5].number, leaf[6].number);
    pose.linear() =
        Eigen::Quaterniond(leaf[10].number, leaf[7].number, leaf[8].number, leaf[9].number)
            .toRotationMatrix();
    return looked_up(leaves, leaf[2].text) * pose;
  }
  throw std::runtime_error("no frame " + frame);
}

} // namespace

TEST_SUITE("mcap_file") {
  TEST_CASE("each frame's messages have its time, measured angles and joints") {
    const RecordedMotion motion(Motion{.ticks = 40});
    const auto source = motion.frames();
    const Mcap mcap = exported(*source, motion.path("take.mcap"));
    const auto joints = on_topic(mcap, "/joint_states");
    const auto transforms = on_topic(mcap, "/tf");
    REQUIRE(joints.size() == 40);
    REQUIRE(transforms.size() == 40);
    const auto again = motion.frames();
    for (std::size_t at = 0; at < 40; ++at) {
      REQUIRE(again->next());
      const flow::Frame& frame = again->frame();
      const auto angles = decoded(mcap, joints[at]);
      const auto tf = decoded(mcap, transforms[at]);
      const std::uint64_t time_ns =
          begun_ns + static_cast<std::uint64_t>(std::llround(1e9 * motion.times_s[at]));
      CHECK(joints[at].log_ns == time_ns);
      CHECK(joints[at].publish_ns == time_ns);
      CHECK(stamp_of(angles) == time_ns);
      CHECK(stamp_of(tf) == time_ns);
      CHECK(joints[at].sequence == at);
      CHECK(joints_of(angles) == measured_in(frame));
      CHECK(joints_of(angles).contains("left_index_mcp_flexion"));
      for (const Side side : {Side::left, Side::right}) {
        const flow::HandFrame& hand = frame.hands[flow::Placement::index_of(side)];
        const std::string name = std::string(name_of(side)) + "_";
        for (const hand::Joint joint :
             {hand::Joint::wrist, hand::Joint::thumb_tip, hand::Joint::little_tip}) {
          const Eigen::Vector3d own_m = hand.pose[joint].translation();
          const Eigen::Vector3d in_ros(-own_m.z(), -own_m.x(), own_m.y());
          const auto pose = looked_up(tf, name + std::string(hand::name_of(joint)));
          CHECK((pose.translation() - in_ros).norm() < 1e-12);
        }
      }
    }
  }

  TEST_CASE("channels have the profiles and hashes of ROS 2") {
    const RecordedMotion motion(Motion{.ticks = 3});
    const auto source = motion.frames();
    const Mcap mcap = exported(*source, motion.path("take.mcap"));
    REQUIRE(mcap.channels.size() == 4);
    for (const auto& [id, channel] : mcap.channels) {
      CHECK(channel.metadata.at("topic_type_hash") ==
            test::Ros2Schema(channel.schema_name, channel.schema).hash());
      CHECK((channel.metadata.at("offered_qos_profiles").find("durability: 1") !=
             std::string::npos) == (channel.topic == "/tf_static"));
    }
    const auto fixed = on_topic(mcap, "/tf_static");
    REQUIRE(fixed.size() == 1);
    CHECK(fixed[0].log_ns == mcap.statistics.first_ns);
    CHECK(decoded(mcap, fixed[0])[3].text == "stage_y_up");
  }

  TEST_CASE("the commands have the times of the ticks that took them") {
    const RecordedMotion motion(Motion{
        .mode = flow::Mode::type2, .ticks = 30, .commit_at_tick = 9, .subdivide_at_tick = 20});
    const auto commands = takes::recorded_commands(motion.played.path);
    REQUIRE(commands);
    const auto source = motion.frames();
    const Mcap mcap = exported(*source, motion.path("take.mcap"), *commands);
    std::map<std::string, std::uint64_t> found;
    for (const auto& message : on_topic(mcap, "/nendo/commands"))
      found[decoded(mcap, message)[0].text] = message.log_ns;
    const auto time_of = [&](std::size_t tick) {
      return begun_ns + static_cast<std::uint64_t>(std::llround(1e9 * motion.times_s[tick]));
    };
    REQUIRE(found.contains("commit"));
    CHECK(found.at("commit") == time_of(9));
    REQUIRE(found.contains("subdivide"));
    CHECK(found.at("subdivide") >= time_of(20));
    CHECK(found.at("subdivide") <= time_of(22));
    CHECK(found.size() == 2);
  }

  TEST_CASE("a part of a take has the frames and commands of that part") {
    const RecordedMotion motion(Motion{.ticks = 40});
    const auto source = motion.frames();
    const std::vector<timeline::Event> commands{
        {0.05, flow::Request::undo}, {0.2, flow::Request::commit}, {0.35, flow::Request::redo}};
    const Mcap mcap = exported(*source, motion.path("take.mcap"), commands,
                               {.from_s = 0.095, .to_s = 0.305, .rate_hz = 50.0});
    CHECK(on_topic(mcap, "/tf").size() == 11);
    const auto requests = on_topic(mcap, "/nendo/commands");
    REQUIRE(requests.size() == 1);
    CHECK(decoded(mcap, requests[0])[0].text == "commit");
  }

  TEST_CASE("a hand of a timeline has all angles, and an absent hand none") {
    test::ScriptedFrames source({0.1, 0.2});
    source.change = [](flow::Frame& frame) {
      frame.hands[0].present = true;
      frame.hands[0].pose.joints.fill(Eigen::Isometry3d::Identity());
    };
    const test::TemporaryFolder folder;
    const Mcap mcap = exported(source, folder.path() / "a.mcap");
    for (const auto& message : on_topic(mcap, "/joint_states"))
      CHECK(joints_of(decoded(mcap, message)).size() == hand::angle_count);
  }

  TEST_CASE("no file replaces another if a number is not finite, or no hand is there") {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "a.mcap";
    test::write_bytes(path, "precious");
    for (const bool has_hand : {false, true}) {
      test::ScriptedFrames source({0.1, 0.2});
      source.change = [has_hand](flow::Frame& frame) {
        frame.hands[0].present = has_hand;
        frame.hands[0].pose.joints.fill(Eigen::Isometry3d::Identity());
        if (frame.tick == 1)
          frame.hands[0].angles.palm_arch_rad = std::numeric_limits<double>::quiet_NaN();
      };
      auto frames = ChosenFrames::make(source, {});
      REQUIRE(frames);
      const auto done = export_mcap(*frames, {}, {}, path);
      REQUIRE_FALSE(done);
      CHECK(done.error().code == Errc::bad_input);
      CHECK(done.error().message.starts_with(path.string() + ": "));
      CHECK(test::file_bytes(path) == "precious");
      CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
    }
  }
}

} // namespace mcap_file_test
