#include "ros2/dds_messages.hpp"

#include <cstdint>
#include <string>

namespace nendo::ros2 {
namespace {

// DDS only reads what it writes to others, although the structs are not const.
char* text_of(const std::string& text) noexcept {
  return const_cast<char*>(text.c_str());
}

template <class Sequence, class Element>
void show(const std::vector<Element>& elements, Sequence& out) noexcept {
  out._length = out._maximum = static_cast<std::uint32_t>(elements.size());
  out._buffer = const_cast<Element*>(elements.data());
  out._release = false;
}

std_msgs_msg_dds__Header_ header_of(const ros::Header& header) noexcept {
  return {{header.stamp.sec, header.stamp.nanosec}, text_of(header.frame_id)};
}

geometry_msgs_msg_dds__Quaternion_ turn_of(const ros::Quaternion& turn) noexcept {
  return {turn.x, turn.y, turn.z, turn.w};
}

} // namespace

const sensor_msgs_msg_dds__JointState_& DdsMessages::of(const ros::JointState& message) {
  names_.clear();
  for (const std::string& name : message.name)
    names_.push_back(text_of(name));
  joint_state_.header_ = header_of(message.header);
  show(names_, joint_state_.name_);
  show(message.position, joint_state_.position_);
  show(message.velocity, joint_state_.velocity_);
  show(message.effort, joint_state_.effort_);
  return joint_state_;
}

const tf2_msgs_msg_dds__TFMessage_& DdsMessages::of(const ros::TFMessage& message) {
  transforms_.clear();
  for (const ros::TransformStamped& one : message.transforms) {
    const ros::Vector3& at = one.transform.translation;
    transforms_.push_back({header_of(one.header),
                           text_of(one.child_frame_id),
                           {{at.x, at.y, at.z}, turn_of(one.transform.rotation)}});
  }
  show(transforms_, tf_message_.transforms_);
  return tf_message_;
}

const geometry_msgs_msg_dds__PoseArray_& DdsMessages::of(const ros::PoseArray& message) {
  poses_.clear();
  for (const ros::Pose& pose : message.poses)
    poses_.push_back(
        {{pose.position.x, pose.position.y, pose.position.z}, turn_of(pose.orientation)});
  pose_array_.header_ = header_of(message.header);
  show(poses_, pose_array_.poses_);
  return pose_array_;
}

const diagnostic_msgs_msg_dds__DiagnosticArray_&
DdsMessages::of(const ros::DiagnosticArray& message) {
  values_.clear();
  for (const ros::DiagnosticStatus& status : message.status)
    for (const ros::KeyValue& value : status.values)
      values_.push_back({text_of(value.key), text_of(value.value)});
  statuses_.clear();
  auto* next = values_.data(); // which stays, from here on
  for (const ros::DiagnosticStatus& status : message.status) {
    const auto count = static_cast<std::uint32_t>(status.values.size());
    statuses_.push_back({static_cast<std::uint8_t>(status.level),
                         text_of(status.name),
                         text_of(status.message),
                         text_of(status.hardware_id),
                         {count, count, next, false}});
    next += count;
  }
  diagnostic_array_.header_ = header_of(message.header);
  show(statuses_, diagnostic_array_.status_);
  return diagnostic_array_;
}

} // namespace nendo::ros2
