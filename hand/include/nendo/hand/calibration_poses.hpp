#pragma once
// The poses of the guided calibration: instructions for the wearer, and assumed joint angles.
// Straight, hook, fist, table top and straight fist are the tendon gliding exercises of hand
// therapy (Wehbe, Hunter 1985): each bends different joints, and they are well known. The edge of a
// table bends PIP joints to an angle that does not depend on the wearer's judgement.

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

/// The assumed angle of a joint in a pose.
struct AssumedAngle {
  double angle_rad = 0.0;
  double deviation_rad = 0.0; ///< standard deviation among wearers; 0: not assumed
  /// The wearer bends the joint by feel, without a stop. The error is partly systematic: the same
  /// each time.
  bool by_feel = false;

  constexpr bool known() const noexcept { return deviation_rad > 0.0; }
};

/// A touch of the pad of the thumb with the pad of a finger, or with the palm at the base of a
/// finger. The pads meet palmar and proximal of both tips of the skeleton (HandSkeleton::pad()). At
/// a finger's base, which is a proximal joint, the palm's surface is `palm_depth_m` to the palmar
/// side, in the axes of the finger's metacarpal.
struct Touch {
  Joint with = Joint::index_tip;
  double deviation_m =
      0.002; ///< standard deviation of each coordinate, between touches of one wearer
};
inline constexpr double palm_depth_m = 0.012;

struct CalibrationPose {
  std::string_view name;        ///< "pinch_index" and so on
  std::string_view instruction; ///< a sentence to be read or spoken to the wearer
  /// The assumed angles by sensor slot, as in SensorAngles: abduction is the angle between two
  /// fingers.
  std::array<AssumedAngle, sensor_slots> assumed{};
  std::optional<Touch> touch{};
};

NENDO_API const CalibrationPose& pose_of(PoseId id) noexcept;
NENDO_API std::optional<PoseId> pose_named(std::string_view name) noexcept;

/// Returns flat and fist, the poses of the quick calibration.
NENDO_API std::span<const PoseId> quick_poses() noexcept;
/// Returns all poses, in a comfortable order.
NENDO_API std::span<const PoseId> full_poses() noexcept;
/// Returns the poses that determine the slips of sensors, in about twenty seconds: flat, fist and
/// the four pinches.
NENDO_API std::span<const PoseId> touch_up_poses() noexcept;
/// Returns the sequence of poses of a full calibration: all of them, then the most informative ones
/// once or twice more. No two successive takes have the same pose.
NENDO_API std::span<const PoseId> full_takes() noexcept;

} // namespace nendo::hand
