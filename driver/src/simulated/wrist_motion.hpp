#pragma once
// Motions of a simulated tracker's stations: the true pose of a receiver as a pure function of
// motion, station, seed and time, in the axes of a transmitter: x to the front, y to the right,
// z down, metres. The receiver's own axes are the transmitter's while the forearm points to the
// front with the palm down.

#include <array>
#include <cstdint>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_tracker.hpp>

namespace nendo::driver {

enum class WristMotion : std::uint8_t {
  rest,  ///< a hand that is held still, with tremor only
  orbit, ///< odd stations (left hands) and even ones go round a point, with palms down
  walk,  ///< the same with palms inwards, faster, and up and down
  table, ///< the exercise for the calibration: the hand lies on a table, the elbow draws circles
  cross, ///< to and fro through the transmitter's plane x = 0
};

/// Returns the motion of that name, one of wrist_motion_names(). Error: usage, naming them.
NENDO_API Result<WristMotion> find_wrist_motion(std::string_view name);

struct ReceiverPose {
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{0, 0, 0, 1};
};

/// Where the wrist's centre is in the receiver's frame: the receiver is on the forearm's strap.
inline constexpr std::array<double, 3> receiver_to_wrist_m{0.06, 0.0, 0.025};

/// Returns the pose at `time_s` >= 0. It is continuous; orbit, walk and cross begin from rest.
NENDO_API ReceiverPose receiver_pose(WristMotion motion, std::uint16_t station, std::uint32_t seed,
                                     double time_s) noexcept;

/// The angles of the forearm in the motion `table`, in radians, about the axes z and y of the
/// transmitter; it turns about y first, and about its own z then. The hand is still, so the wrist's
/// joints turn by the opposite angles, in the order that HandSkeleton has.
struct ForearmAngles {
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
};
NENDO_API ForearmAngles forearm_angles(double time_s) noexcept;

} // namespace nendo::driver
