#pragma once
// Closes pinches. With calibrated angles, touching pads are still some millimetres apart, but users
// who feel a pinch expect to see it. If the pad of a finger is near the thumb's pad, the joints of
// both are rotated so that the pads meet: by the smallest rotation, weighted by each joint's
// uncertainty.

#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// Pads nearer than closed_pinch_m are closed; pads farther apart than open_pinch_m do not move. In
/// between, the correction decreases smoothly.
inline constexpr double closed_pinch_m = 0.012;
inline constexpr double open_pinch_m = 0.022;

/// Returns the angles with pinches closed. Only joints of the thumb and of fingers with pads near
/// its pad change, and the change moves none out of its range (joint_limits). Sensors in `present`
/// and not in `left_out` measured the angles; estimated joints turn more easily. The result depends
/// only on the arguments, and smoothly on the angles, so that nothing jumps when a pinch begins or
/// ends. Angles that are not finite are returned unchanged. Wait-free, no allocation.
NENDO_API JointAngles close_pinches(const JointAngles& angles, const HandSkeleton& skeleton,
                                    SensorMask present, SensorMask left_out = {}) noexcept;

} // namespace nendo::hand
