#pragma once
// Hands as messages of ROS 2: joint states, transforms and poses. README.md has the names of joints
// and frames, and the axes.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include <nendo/base/side.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/hand/joints.hpp>

#include "ros/messages.hpp"

namespace nendo::ros {

/// A pose on the stage: x to the right, y up, z to the operator.
struct StagePose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity(); ///< a unit quaternion
};

/// A hand that a glove drives, at one time. A frame of a loop has all of this (state_of()), and so
/// have a record and its states in a published segment.
struct HandState {
  Side side = Side::left;
  std::array<StagePose, hand::joint_count> joints{};  ///< index: hand::index_of(Joint)
  StagePose forearm{};                                ///< its end, from which the wrist turns
  std::array<double, hand::angle_count> angles_rad{}; ///< index: hand::index_of(Angle)
  std::uint32_t measured = 0; ///< bit k: sensors measure angle k; other angles are estimates
};

/// Makes the messages. Functions that get a message overwrite it, and keep its memory, so that they
/// allocate only in first calls and for more hands. Each function depends on its arguments only,
/// and may be called in several threads at a time.
class HandMessages {
public:
  /// prefix: begins each name of a joint and of a frame, such as "operator_1/".
  explicit HandMessages(std::string_view prefix = {});

  /// The measured angles of the hands in radians. Estimates are left out: no sensor is behind them.
  void joint_states(std::span<const HandState> hands, std::int64_t utc_ns, JointState& out) const;
  /// The frames of the hands, each in its parent's: forearm, wrist, and then the other joints, as
  /// in hand::parent_of().
  void transforms(std::span<const HandState> hands, std::int64_t utc_ns, TFMessage& out) const;
  /// The frame `stage_y_up` in the frame `stage`, which is always the same.
  TFMessage static_transforms(std::int64_t utc_ns) const;
  /// The 26 joints in the order of hand::Joint, in the frame `stage`.
  void poses(const HandState& hand, std::int64_t utc_ns, PoseArray& out) const;

  /// The frame of the stage with the axes of REP-103: x away from the operator, y left, z up.
  const std::string& stage() const noexcept { return stage_; }
  /// The same place with the stage's own axes: x right, y up, z to the operator.
  const std::string& stage_y_up() const noexcept { return stage_y_up_; }

private:
  struct Names {
    std::string forearm;
    std::array<std::string, hand::joint_count> joints;
    std::array<std::string, hand::angle_count> angles;
  };

  const Names& names_of(Side side) const noexcept { return names_[static_cast<std::size_t>(side)]; }

  std::string stage_;
  std::string stage_y_up_;
  std::array<Names, 2> names_; ///< index: Side
};

} // namespace nendo::ros
