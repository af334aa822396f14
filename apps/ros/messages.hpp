#pragma once
// The messages of ROS 2 by which hands are published, as plain structs. The members have the names
// and the order of the fields in ROS's message definitions.

#include <cstdint>
#include <string>
#include <vector>

namespace nendo::ros {

/// builtin_interfaces/msg/Time: a time in UTC, since 1970.
struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  friend bool operator==(const Time&, const Time&) = default;
};

/// Converts nanoseconds since 1970 in UTC. A time before 1970 becomes 0, and one that `sec` cannot
/// hold, from 2038 on, the last that it can.
Time time_of(std::int64_t utc_ns) noexcept;

/// std_msgs/msg/Header
struct Header {
  Time stamp;
  std::string frame_id;
};

/// std_msgs/msg/String
struct String {
  std::string data;
};

/// sensor_msgs/msg/JointState: one position for each name, in radians; no velocities, no efforts.
struct JointState {
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> effort;
};

/// geometry_msgs/msg/Vector3 and geometry_msgs/msg/Point, in metres.
struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};
using Point = Vector3;

/// geometry_msgs/msg/Quaternion
struct Quaternion {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};

/// geometry_msgs/msg/Transform
struct Transform {
  Vector3 translation;
  Quaternion rotation;
};

/// geometry_msgs/msg/Pose
struct Pose {
  Point position;
  Quaternion orientation;
};

/// geometry_msgs/msg/TransformStamped: the pose of `child_frame_id` in the frame of the header.
struct TransformStamped {
  Header header;
  std::string child_frame_id;
  Transform transform;
};

/// tf2_msgs/msg/TFMessage
struct TFMessage {
  std::vector<TransformStamped> transforms;
};

/// geometry_msgs/msg/PoseArray
struct PoseArray {
  Header header;
  std::vector<Pose> poses;
};

/// diagnostic_msgs/msg/KeyValue
struct KeyValue {
  std::string key;
  std::string value;
};

/// The levels of a DiagnosticStatus, which are bytes there.
enum class DiagnosticLevel : std::uint8_t { ok = 0, warn = 1, error = 2, stale = 3 };

/// diagnostic_msgs/msg/DiagnosticStatus
struct DiagnosticStatus {
  DiagnosticLevel level = DiagnosticLevel::ok;
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;
};

/// diagnostic_msgs/msg/DiagnosticArray
struct DiagnosticArray {
  Header header;
  std::vector<DiagnosticStatus> status;
};

} // namespace nendo::ros
