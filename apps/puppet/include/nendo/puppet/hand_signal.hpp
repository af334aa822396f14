#pragma once
// The input of a puppet from a hand: one number of its pose. Angles are steadier than places,
// because a fingertip's place mixes three joints and the wrist.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/side.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::puppet {

/// A hand at one moment.
struct HandState {
  hand::JointAngles angles;
  hand::HandPose pose;
  Eigen::Isometry3d T_world_wrist = Eigen::Isometry3d::Identity();
};

/// One number of a hand's pose. Its name is the hand, a point, and one of
/// - thumb_flexion to little_flexion: what all joints of the finger are bent by, radians;
/// - a joint angle (hand::Angle): thumb_roll, index_mcp_abduction, wrist_yaw and so on, radians;
/// - thumb_tip_x to little_tip_z: the fingertip's place along an axis of the wrist, metres. x goes
///   to the side of the little finger, so that hands that mirror each other have the same signals.
class NENDO_API HandSignal {
public:
  HandSignal() = default;
  /// Returns nothing if there is no such signal.
  static std::optional<HandSignal> named(std::string_view name) noexcept;
  /// Returns the signal of that number; nothing if there is none. Recordings keep the numbers.
  static std::optional<HandSignal> numbered(Side side, std::uint8_t number) noexcept;
  /// Returns the signal of the other hand.
  HandSignal mirrored() const noexcept;

  std::string name() const;
  Side side() const noexcept { return side_; }
  std::uint8_t number() const noexcept { return number_; }
  bool is_angle() const noexcept; ///< radians; otherwise metres
  static constexpr std::uint8_t no_finger = 5;
  /// Returns the finger to which it belongs, 0 thumb to 4 little finger; no_finger: palm or wrist.
  std::uint8_t finger() const noexcept;
  /// Of a fingertip's place: the way along which the signal grows, in the axes of the wrist.
  Eigen::Vector3d direction() const noexcept;
  /// Returns its value. Wait-free; no allocation.
  double of(const HandState& hand) const noexcept;
  friend bool operator==(const HandSignal&, const HandSignal&) = default;

private:
  HandSignal(Side side, std::uint8_t number) noexcept : side_(side), number_(number) {}

  Side side_ = Side::left;
  std::uint8_t number_ = 0; ///< five flexions, then all angles, then 5 tips times 3 axes
};

} // namespace nendo::puppet
