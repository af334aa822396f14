#include "ros/hand_messages.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace nendo::ros {
namespace {

constexpr std::size_t frames_per_hand = hand::joint_count + 1; // the joints and the forearm

// The axes of REP-103 are those of the stage and of OpenXR's joints with other names: forward is
// -z, left is -x, up is y. So the vector part of a quaternion changes as a vector does.
Vector3 ros_vector(const Eigen::Vector3d& vector) noexcept {
  return {-vector.z(), -vector.x(), vector.y()};
}
Quaternion ros_turn(const Eigen::Quaterniond& turn) noexcept {
  return {-turn.z(), -turn.x(), turn.y(), turn.w()};
}

Transform transform_of(const StagePose& parent, const StagePose& child) noexcept {
  const Eigen::Quaterniond back = parent.orientation.conjugate();
  return {ros_vector(back * (child.position_m - parent.position_m)),
          ros_turn((back * child.orientation).normalized())};
}

} // namespace

Time time_of(std::int64_t utc_ns) noexcept {
  constexpr std::int64_t per_second = 1'000'000'000;
  constexpr std::int64_t max_sec = std::numeric_limits<std::int32_t>::max();
  const std::int64_t ns =
      std::clamp(utc_ns, std::int64_t{0}, max_sec * per_second + (per_second - 1));
  return {static_cast<std::int32_t>(ns / per_second), static_cast<std::uint32_t>(ns % per_second)};
}

HandMessages::HandMessages(std::string_view prefix)
    : stage_(std::string(prefix) + "stage"), stage_y_up_(std::string(prefix) + "stage_y_up") {
  for (const Side side : {Side::left, Side::right}) {
    Names& names = names_[static_cast<std::size_t>(side)];
    const std::string hand = std::string(prefix) + std::string(name_of(side)) + "_";
    names.forearm = hand + "forearm";
    for (std::size_t at = 0; at < hand::joint_count; ++at)
      names.joints[at] = hand + std::string(hand::name_of(static_cast<hand::Joint>(at)));
    for (std::size_t at = 0; at < hand::angle_count; ++at)
      names.angles[at] = hand + std::string(hand::angle_names[at]);
  }
}

void HandMessages::joint_states(std::span<const HandState> hands, std::int64_t utc_ns,
                                JointState& out) const {
  out.header.stamp = time_of(utc_ns);
  out.header.frame_id.clear(); // joints are in no frame
  out.position.clear();
  out.velocity.clear();
  out.effort.clear();
  std::size_t count = 0;
  for (const HandState& hand : hands) {
    for (std::size_t at = 0; at < hand::angle_count; ++at) {
      if ((hand.measured >> at & 1U) == 0) continue;
      if (count == out.name.size()) out.name.emplace_back();
      out.name[count++] = names_of(hand.side).angles[at];
      out.position.push_back(hand.angles_rad[at]);
    }
  }
  out.name.resize(count);
}

void HandMessages::transforms(std::span<const HandState> hands, std::int64_t utc_ns,
                              TFMessage& out) const {
  out.transforms.resize(hands.size() * frames_per_hand);
  auto next = out.transforms.begin();
  const auto add = [&](const std::string& parent, const std::string& child,
                       const Transform& transform) {
    next->header.stamp = time_of(utc_ns);
    next->header.frame_id = parent;
    next->child_frame_id = child;
    next->transform = transform;
    ++next;
  };
  for (const HandState& hand : hands) {
    const Names& names = names_of(hand.side);
    add(stage_, names.forearm, transform_of({}, hand.forearm));
    for (std::size_t at = 0; at < hand::joint_count; ++at) {
      const std::optional<hand::Joint> parent = hand::parent_of(static_cast<hand::Joint>(at));
      add(parent ? names.joints[hand::index_of(*parent)] : names.forearm, names.joints[at],
          transform_of(parent ? hand.joints[hand::index_of(*parent)] : hand.forearm,
                       hand.joints[at]));
    }
  }
}

TFMessage HandMessages::static_transforms(std::int64_t utc_ns) const {
  const Quaternion turn{0.5, -0.5, -0.5, 0.5}; // turns ROS's x, y, z to the right, up, back
  return {{{{time_of(utc_ns), stage_}, stage_y_up_, {{}, turn}}}};
}

void HandMessages::poses(const HandState& hand, std::int64_t utc_ns, PoseArray& out) const {
  out.header.stamp = time_of(utc_ns);
  out.header.frame_id = stage_;
  out.poses.resize(hand::joint_count);
  std::transform(hand.joints.begin(), hand.joints.end(), out.poses.begin(),
                 [](const StagePose& joint) {
                   return Pose{ros_vector(joint.position_m), ros_turn(joint.orientation)};
                 });
}

} // namespace nendo::ros
