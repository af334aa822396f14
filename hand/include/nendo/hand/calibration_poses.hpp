#pragma once
// The poses of the guided calibration: what a wearer is asked to do, and what that says about the
// joints. Straight, hook, fist, table top and straight fist are the tendon gliding exercises of
// hand therapy (Wehbe, Hunter 1985): each bends different joints, and people know how to do them.
// The edge of a table bends PIP joints to an angle that does not depend on the wearer's judgement.

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
  /// The wearer bends the joint to where it feels right, and nothing holds it there. The error is
  /// partly a habit, which is the same each time.
  bool by_feel = false;

  constexpr bool known() const noexcept { return deviation_rad > 0.0; }
};

/// A touch of the pad of the thumb with the pad of a finger, or with the palm at the base of a
/// finger. Bones end at the skeleton's tips, and soft pads lie between them: pads meet
/// to the palmar side of either tip and behind it (HandSkeleton::pad()). At a finger's
/// base, which is a proximal joint, the flesh is `palm_depth_m` deep to the palmar side, by the
/// axes of the finger's metacarpal.
struct Touch {
  Joint with = Joint::index_tip;
  double deviation_m =
      0.002; ///< standard deviation of each coordinate, between touches of one wearer
};
inline constexpr double palm_depth_m = 0.012;

struct CalibrationPose {
  std::string_view name;        ///< "pinch_index" and so on
  std::string_view instruction; ///< a sentence to be read or spoken to the wearer
  /// The assumed angles by sensor slot, as in SensorAngles: those of the abduction sensors are of
  /// pairs of fingers.
  std::array<AssumedAngle, sensor_slots> assumed{};
  std::optional<Touch> touch{};
};

NENDO_API const CalibrationPose& pose_of(PoseId id) noexcept;
NENDO_API std::optional<PoseId> pose_named(std::string_view name) noexcept;

/// Returns flat and fist, the poses of the quick calibration.
NENDO_API std::span<const PoseId> quick_poses() noexcept;
/// Returns all poses, in an order that is easy on the hand.
NENDO_API std::span<const PoseId> full_poses() noexcept;
/// Returns the poses that show how far sensors have slipped, in some twenty seconds: flat, fist and
/// the four pinches.
NENDO_API std::span<const PoseId> touch_up_poses() noexcept;
/// Returns the poses that a full calibration asks for: all of them, then some once or twice more,
/// because they say most, or alone, about a joint. No take asks for the same pose as the take
/// before it.
NENDO_API std::span<const PoseId> full_takes() noexcept;

} // namespace nendo::hand
