#pragma once
// The range of motion of each joint, and the soft stops that keep an angle within it. Readings
// often exceed a joint's range, mostly because of a wrong calibration. A hard clamp would freeze
// such a joint. A soft stop compresses the angles beyond its start into the rest of the range, so
// that the joint still moves and no pose is impossible.

#include <array>

#include <nendo/base/units.hpp>
#include <nendo/hand/angle.hpp>

namespace nendo::hand {

/// A joint's range of motion, radians: min < soft_min < soft_max < max.
struct NENDO_API JointLimit {
  double min_rad;
  double soft_min_rad; ///< below it, angles are compressed
  double soft_max_rad; ///< above it, angles are compressed
  double max_rad;

  /// Returns the angle itself from soft_min to soft_max, and beyond them an angle between the soft
  /// stop and the end of the range. Monotone, with a continuous slope; an angle at the end is
  /// mapped halfway between soft stop and end. The result is finite for every double: NaN becomes
  /// the lower end. Wait-free.
  double soften(double angle_rad) const noexcept;
};

constexpr JointLimit limit_deg(double least, double soft_min, double soft_max,
                               double most) noexcept {
  return {from_degrees(least), from_degrees(soft_min), from_degrees(soft_max), from_degrees(most)};
}

// Ranges of motion from clinical goniometry (American Academy of Orthopaedic Surgeons: finger MCP 0
// to 90 and 20 to 30 of extension, PIP 0 to 100, DIP 0 to 80, thumb MCP 0 to 55, IP 0 to 80, wrist
// 70 to 80, 20 and 30 to the sides), slightly widened. Readings beyond them are usually calibration
// errors. The soft stops begin at the clinical ends or beyond, so that they change neither a flat
// hand nor a full fist. Where goniometry has no angle (spreading, thumb roll, palm arch), the range
// is that of a spread or cupped hand: neighbouring fingers spread by 25 degrees, summed from the
// middle finger outwards.
inline constexpr JointLimit finger_mcp_limit = limit_deg(-30, -20, 90, 100);
inline constexpr JointLimit finger_pip_limit = limit_deg(-10, -5, 105, 115);
inline constexpr JointLimit finger_dip_limit = limit_deg(-10, -5, 80, 85);

/// The limits of all joints, by index_of(Angle).
inline constexpr std::array<JointLimit, angle_count> joint_limits{{
    limit_deg(-20, -10, 80, 90), // thumb_roll
    limit_deg(-10, -5, 60, 70),  // thumb_abduction
    limit_deg(-20, -10, 60, 70), // thumb_mcp_flexion
    limit_deg(-20, -10, 80, 90), // thumb_ip_flexion
    finger_mcp_limit,            // index
    limit_deg(-15, -10, 30, 40),
    finger_pip_limit,
    finger_dip_limit,
    finger_mcp_limit, // middle
    limit_deg(-20, -15, 15, 20),
    finger_pip_limit,
    finger_dip_limit,
    finger_mcp_limit, // ring
    limit_deg(-40, -30, 10, 15),
    finger_pip_limit,
    finger_dip_limit,
    finger_mcp_limit, // little
    limit_deg(-70, -55, 20, 30),
    finger_pip_limit,
    finger_dip_limit,
    limit_deg(-5, -2, 30, 35),   // palm_arch
    limit_deg(-75, -70, 80, 85), // wrist_pitch
    limit_deg(-40, -30, 20, 30), // wrist_yaw
}};

constexpr const JointLimit& limit_of(Angle angle) noexcept {
  return joint_limits[index_of(angle)];
}

} // namespace nendo::hand
