// The bytes of messages, read by a reader that knows the schema only.

#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "ros/cdr.hpp"
#include "ros/scene.hpp"
#include "ros/types.hpp"
#include "support/ros2msg.hpp"

namespace cdr_test {

using namespace nendo;

namespace {

template <class Message>
std::vector<std::byte> encoded(const Message& message) {
  std::vector<std::byte> bytes;
  ros::append_cdr(message, bytes);
  return bytes;
}

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values)
    bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

template <class Message>
std::vector<test::Ros2Schema::Leaf> read_back(const ros::MessageType& type,
                                              const Message& message) {
  return test::Ros2Schema(std::string(type.name), ros::schema_of(type)).decode(encoded(message));
}

} // namespace

TEST_CASE("a string has its length with a NUL before it") {
  CHECK(encoded(ros::String{"hi"}) == bytes_of({0, 1, 0, 0, 3, 0, 0, 0, 'h', 'i', 0}));
  CHECK(encoded(ros::String{}) == bytes_of({0, 1, 0, 0, 1, 0, 0, 0, 0}));
}

TEST_CASE("numbers are aligned to their size, counted from the end of the head") {
  ros::JointState state;
  state.header.stamp = {1, 2};
  state.header.frame_id = "ab"; // 3 bytes with the NUL, and one to align
  state.name = {"c"};
  state.position = {1.0};
  const auto expected =
      bytes_of({0, 1, 0, 0,                                     // CDR, little-endian
                1, 0, 0, 0, 2,   0,   0,    0,                  // 0: stamp
                3, 0, 0, 0, 'a', 'b', 0,    0,                  // 8: frame, padded to 16
                1, 0, 0, 0, 2,   0,   0,    0,    'c', 0, 0, 0, // 16: one name, padded to 28
                1, 0, 0, 0,                                     // 28: one position, at 32
                0, 0, 0, 0, 0,   0,   0xF0, 0x3F,               // 32
                0, 0, 0, 0, 0,   0,   0,    0});                // no velocity, no effort
  CHECK(encoded(state) == expected);
}

TEST_CASE("a message is the same behind any number of bytes") {
  const ros::String message{"behind"};
  for (std::size_t before = 0; before < 9; ++before) {
    std::vector<std::byte> bytes(before, std::byte{0xEE});
    ros::append_cdr(message, bytes);
    CHECK(std::vector(bytes.begin() + static_cast<std::ptrdiff_t>(before), bytes.end()) ==
          encoded(message));
  }
}

TEST_CASE("joint states are read back by their schema") {
  ros::JointState state;
  state.header.stamp = {1'700'000'000, 999'999'999};
  state.name = {"left_index_mcp_flexion", "x", "", "right_wrist_yaw"};
  state.position = {0.1, -1e-300, 3.5e7, -0.0};
  const auto leaves = read_back(ros::joint_state_type, state);
  REQUIRE(leaves.size() == 3 + 4 + 4);
  CHECK(leaves[0].number == 1'700'000'000);
  CHECK(leaves[1].number == 999'999'999);
  CHECK(leaves[2].path == "header.frame_id");
  for (std::size_t at = 0; at < 4; ++at) {
    CHECK(leaves[3 + at].path == "name[" + std::to_string(at) + "]");
    CHECK(leaves[3 + at].text == state.name[at]);
    CHECK(std::bit_cast<std::uint64_t>(leaves[7 + at].number) ==
          std::bit_cast<std::uint64_t>(state.position[at]));
  }
}

TEST_CASE("transforms and poses are read back by their schemas") {
  ros::TFMessage tf;
  ros::PoseArray poses;
  poses.header = {{5, 6}, "stage"};
  for (const std::string name : {"a", "ab", "abc", "abcd", "abcde"}) { // all alignments
    const auto number = static_cast<double>(name.size());
    const ros::Quaternion turn{number / 10, -0.5, 0.25, -0.125};
    tf.transforms.push_back({{{7, 8}, name}, name + "!", {{number, 2.0, 3.0}, turn}});
    poses.poses.push_back({{-number, 0.5, 1e9}, turn});
  }
  const auto leaves = read_back(ros::tf_message_type, tf);
  REQUIRE(leaves.size() == 5 * 11);
  for (std::size_t at = 0; at < 5; ++at) {
    const auto* const leaf = &leaves[11 * at];
    const ros::TransformStamped& own = tf.transforms[at];
    CHECK(leaf[2].text == own.header.frame_id);
    CHECK(leaf[3].text == own.child_frame_id);
    CHECK(leaf[3].path == "transforms[" + std::to_string(at) + "].child_frame_id");
    CHECK(leaf[4].number == own.transform.translation.x);
    CHECK(leaf[6].number == own.transform.translation.z);
    CHECK(leaf[7].number == own.transform.rotation.x);
    CHECK(leaf[10].number == own.transform.rotation.w);
  }
  const auto read = read_back(ros::pose_array_type, poses);
  REQUIRE(read.size() == 3 + 5 * 7);
  CHECK(read[2].text == "stage");
  for (std::size_t at = 0; at < 5; ++at) {
    CHECK(read[3 + 7 * at].number == poses.poses[at].position.x);
    CHECK(read[9 + 7 * at].path == "poses[" + std::to_string(at) + "].orientation.w");
    CHECK(read[9 + 7 * at].number == poses.poses[at].orientation.w);
  }
}

TEST_CASE("a surface is read back as the only entity of a scene") {
  for (const std::string frame : {"", "a", "stage", "stages_"}) { // all alignments
    const ros::SceneSurface surface{{7, 8},
                                    frame,
                                    "model",
                                    {{0.5, 1.0, -2.0}, {3.0, 4.0, 5.0}, {1e-9, 0.0, 7.0}},
                                    {0, 1, 2, 2, 1, 0},
                                    {0.1, 0.2, 0.3, 1.0}};
    const auto leaves = read_back(ros::scene_update_type, surface);
    std::vector<double> numbers;
    std::vector<std::string> names;
    for (const auto& leaf : leaves) {
      CHECK(leaf.path.starts_with("entities[0]."));
      if (leaf.path.starts_with("entities[0].triangles[0].")) {
        numbers.push_back(leaf.number);
      } else if (leaf.path == "entities[0].frame_id" || leaf.path == "entities[0].id") {
        names.push_back(leaf.text);
      }
    }
    CHECK(names == std::vector<std::string>{frame, "model"});
    CHECK(numbers == std::vector<double>{0,   0,   0,   0, 0, 0, 1,          // pose
                                         0.5, 1,   -2,  3, 4, 5, 1e-9, 0, 7, // points
                                         0.1, 0.2, 0.3, 1,                   // colour
                                         0,   1,   2,   2, 1, 0});           // corners
    CHECK(leaves.size() == numbers.size() + 7); // times, names and a flag of the entity
  }
}

} // namespace cdr_test
