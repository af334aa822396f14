#pragma once
// The types of the messages, and the topics on which ROS 2 expects them.

#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/base/side.hpp>

namespace nendo::ros {

/// A type of messages.
struct MessageType {
  std::string_view name; ///< such as "sensor_msgs/msg/JointState"
  /// The type's hash (REP-2016), as since ROS 2 Iron each endpoint of DDS has it in its user data,
  /// and each topic of a recording in its metadata: "RIHS01_" and 64 hexadecimal digits.
  std::string_view hash;
};

inline constexpr MessageType string_type{
    "std_msgs/msg/String",
    "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"};
inline constexpr MessageType joint_state_type{
    "sensor_msgs/msg/JointState",
    "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"};
inline constexpr MessageType tf_message_type{
    "tf2_msgs/msg/TFMessage",
    "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"};
inline constexpr MessageType pose_array_type{
    "geometry_msgs/msg/PoseArray",
    "RIHS01_af0cc36d190e104d546d168d6b39df04fa4b4ccecf59cb4c9ed328d3d5004aa0"};
inline constexpr MessageType diagnostic_array_type{
    "diagnostic_msgs/msg/DiagnosticArray",
    "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"};

/// Returns the definition of a type in the encoding `ros2msg`: its fields, and then, after a line
/// of 80 `=` and one with the name, those of each type that it contains. `type` must be one of the
/// above.
std::string schema_of(const MessageType& type);

/// How a topic is published. All are reliable, and keep the last messages.
struct Qos {
  std::uint32_t depth = 10;        ///< number of messages that are kept
  bool is_transient_local = false; ///< readers that come later get the last messages
};

/// Returns the profile as rosbag2 writes it to the metadata `offered_qos_profiles` of a topic: a
/// list in YAML, with numbers in place of names, which is rosbag2's form before version 9.
std::string offered_qos_profiles(const Qos& qos);

struct Topic {
  std::string_view name;
  MessageType type;
  Qos qos;
};

// tf2_ros publishes transforms with these two profiles.
inline constexpr Topic joint_states_topic{"/joint_states", joint_state_type, {}};
inline constexpr Topic tf_topic{"/tf", tf_message_type, {100, false}};
inline constexpr Topic tf_static_topic{"/tf_static", tf_message_type, {1, true}};
/// The requests to a run, such as "grab" and "undo".
inline constexpr Topic commands_topic{"/nendo/commands", string_type, {}};
/// The 26 joints of a hand (HandMessages::poses()).
constexpr Topic joints_topic(Side side) noexcept {
  return {side == Side::left ? "/nendo/left/joints" : "/nendo/right/joints", pose_array_type, {}};
}
/// The states of gloves and trackers, where ROS 2 expects those of all devices.
inline constexpr Topic diagnostics_topic{"/diagnostics", diagnostic_array_type, {}};

} // namespace nendo::ros
