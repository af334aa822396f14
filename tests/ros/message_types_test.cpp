// Names, schemas, hashes and profiles of the published messages.

#include <string>

#include <doctest/doctest.h>

#include "ros/scene.hpp"
#include "ros/types.hpp"
#include "support/ros2msg.hpp"
#include "support/sha256.hpp"

namespace message_types_test {

using namespace nendo;

namespace {

constexpr ros::MessageType all_types[] = {ros::string_type,           ros::joint_state_type,
                                          ros::tf_message_type,       ros::pose_array_type,
                                          ros::diagnostic_array_type, ros::scene_update_type};

} // namespace

TEST_CASE("the SHA-256 of these tests is that of FIPS 180-4") {
  CHECK(test::sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(test::sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(test::sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST_CASE("the hash of each type is that of its schema") {
  for (const ros::MessageType& type : all_types) {
    INFO(std::string(type.name));
    CHECK(test::Ros2Schema(std::string(type.name), ros::schema_of(type)).hash() == type.hash);
  }
}

TEST_CASE("another field gives another hash") {
  std::string schema = ros::schema_of(ros::joint_state_type);
  schema.replace(schema.find("effort"), 6, "torque");
  CHECK(test::Ros2Schema("sensor_msgs/msg/JointState", schema).hash() !=
        ros::joint_state_type.hash);
}

TEST_CASE("a schema defines each contained type once, after a line of 80 signs") {
  const std::string schema = ros::schema_of(ros::tf_message_type);
  CHECK(schema.starts_with("geometry_msgs/TransformStamped[] transforms\n"));
  for (const char* type :
       {"geometry_msgs/TransformStamped", "std_msgs/Header", "builtin_interfaces/Time",
        "geometry_msgs/Transform", "geometry_msgs/Vector3", "geometry_msgs/Quaternion"}) {
    const std::string head = std::string(80, '=') + "\nMSG: " + type + "\n";
    INFO(type);
    REQUIRE(schema.find(head) != std::string::npos);
    CHECK(schema.find(head, schema.find(head) + 1) == std::string::npos);
  }
}

TEST_CASE("profiles are those of tf2_ros and of usual publishers") {
  const std::string usual = ros::offered_qos_profiles(ros::joint_states_topic.qos);
  CHECK(usual.starts_with("- history: 1\n  depth: 10\n  reliability: 1\n  durability: 2\n"));
  CHECK(ros::offered_qos_profiles(ros::tf_topic.qos).find("depth: 100\n") != std::string::npos);
  const std::string fixed = ros::offered_qos_profiles(ros::tf_static_topic.qos);
  CHECK(fixed.find("  depth: 1\n") != std::string::npos);
  CHECK(fixed.find("  durability: 1\n") != std::string::npos); // transient local
}

} // namespace message_types_test
