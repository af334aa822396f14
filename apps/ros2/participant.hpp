#pragma once
// The topics of nendo-ros2 in DDS.

#include <cstdint>
#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>

#include "ros/messages.hpp"
#include "ros2/dds_network.hpp"

namespace nendo::ros2 {

/// A participant with a writer for each topic. DDS runs threads of its own; a write does not wait
/// for readers. One thread at a time.
class Participant {
public:
  /// Opens the sockets, and keeps them to this machine if the network says so. Only one at a time.
  /// Errors: usage (CYCLONEDDS_URI); failed (no network).
  static Result<std::unique_ptr<Participant>> open(const DdsNetwork& network);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  void joint_states(const ros::JointState& message);
  void transforms(const ros::TFMessage& message);
  /// Readers that come later also get the last message.
  void static_transforms(const ros::TFMessage& message);
  void poses(Side side, const ros::PoseArray& message);
  void diagnostics(const ros::DiagnosticArray& message);

  /// Returns how many messages DDS has refused.
  std::uint64_t refused() const noexcept;

private:
  struct State;
  explicit Participant(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

} // namespace nendo::ros2
