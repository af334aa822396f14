#pragma once
// The poses of the guided calibration: what a wearer is asked to do, and what that says about the
// joints. Straight, hook, fist, table top and straight fist are the tendon gliding exercises of
// hand therapy (Wehbe, Hunter 1985): each bends other joints, and people know how to do them. A
// table's edge bends PIP joints to an angle that is not the wearer's own to choose.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/joints.hpp>

namespace nendo::hand {

enum class PoseId : std::uint8_t {
  flat,
  fist,
  spread,
  thumb_out,
  thumb_up,
  thumb_across,
  thumb_bent,
  table_top,
  hook,
  straight_fist,
  edge_index,
  edge_little,
  point,
  two,
  three,
  pinch_index,
  pinch_index_flat,
  pinch_middle,
  pinch_ring,
  pinch_little,
  wrist_down,
  wrist_back,
  wrist_inwards,
  wrist_outwards,
};

inline constexpr std::size_t pose_count = 24;

/// The angle that a joint is taken to have in a pose.
struct AssumedAngle {
  double angle_rad = 0.0;
  double deviation_rad = 0.0; ///< how far wearers are off, as a standard deviation; 0: not assumed
  /// Bent to where it feels right, by a habit that is the same each time, and held there by
  /// nothing.
  bool by_feel = false;

  constexpr bool known() const noexcept { return deviation_rad > 0.0; }
};

/// The pad of the thumb touches the pad of a finger, or the palm at the base of one. Bones end
/// where the skeleton's tips are, and soft pads lie between them: pads meet `pad_depth_m` to the
/// palmar side of either tip and `pad_behind_tip_m` behind it; at a finger's base, a proximal
/// joint, flesh is `palm_depth_m` deep to the palmar side, by the axes of its metacarpal.
struct Touch {
  Joint with = Joint::index_tip;
  double deviation_m = 0.002; ///< of each coordinate, between touches of one wearer
};
inline constexpr double pad_depth_m = 0.006;
inline constexpr double pad_behind_tip_m = 0.003;
inline constexpr double palm_depth_m = 0.012;

struct CalibrationPose {
  std::string_view name;        ///< "pinch_index" and so on
  std::string_view instruction; ///< a sentence to be read or spoken to the wearer
  /// By sensor slot, in the terms of SensorAngles: the abduction sensors' are of pairs.
  std::array<AssumedAngle, sensor_slots> assumed{};
  std::optional<Touch> touch{};
};

/// Wait-free.
const CalibrationPose& pose_of(PoseId id) noexcept;
std::optional<PoseId> pose_named(std::string_view name) noexcept;

/// Flat and fist.
std::span<const PoseId> quick_poses() noexcept;
/// All of them, in an order that is easy on the hand.
std::span<const PoseId> full_poses() noexcept;
/// What a full calibration asks for: all of them, then some once more, which are the only ones, or
/// the surest, to tell of a joint. A take is never the pose of the one before.
std::span<const PoseId> full_takes() noexcept;

} // namespace nendo::hand
