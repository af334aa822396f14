#pragma once
// Messages as the structs that idlc makes of ros_messages.idl, which DDS takes.

#include <vector>

#include <ros_messages.h>

#include "ros/messages.hpp"

namespace nendo::ros2 {

/// Shows messages to DDS. What a function returns points into the message and into this object; it
/// is valid until the next call of the same function, and while the message lives. Allocates only
/// when a message is larger than all before.
class DdsMessages {
public:
  const sensor_msgs_msg_dds__JointState_& of(const ros::JointState& message);
  const tf2_msgs_msg_dds__TFMessage_& of(const ros::TFMessage& message);
  const geometry_msgs_msg_dds__PoseArray_& of(const ros::PoseArray& message);
  const diagnostic_msgs_msg_dds__DiagnosticArray_& of(const ros::DiagnosticArray& message);

private:
  std::vector<char*> names_;
  std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms_;
  std::vector<geometry_msgs_msg_dds__Pose_> poses_;
  std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> statuses_;
  std::vector<diagnostic_msgs_msg_dds__KeyValue_> values_;
  sensor_msgs_msg_dds__JointState_ joint_state_{};
  tf2_msgs_msg_dds__TFMessage_ tf_message_{};
  geometry_msgs_msg_dds__PoseArray_ pose_array_{};
  diagnostic_msgs_msg_dds__DiagnosticArray_ diagnostic_array_{};
};

} // namespace nendo::ros2
