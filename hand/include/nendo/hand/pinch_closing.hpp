#pragma once
// Closes pinches. Calibrated angles leave pads that touch some millimetres apart, and a person who
// feels a pinch wants to see it. Where the pad of a finger is near that of the thumb, the joints of
// both are turned so that the pads meet: by the smallest rotation, weighted by each
// joint's uncertainty.

#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// Pads that are this near are closed, and those that are so far apart stay. In between they come
/// nearer by a part that falls smoothly.
inline constexpr double closed_pinch_m = 0.012;
inline constexpr double open_pinch_m = 0.022;

/// Returns the angles with pinches closed. Only joints of the thumb and of fingers whose pads are
/// near its pad change, and none leaves its range (joint_limits) because of it. `present` are the
/// sensors that measured the angles, but for those `left_out`; joints that are only estimated turn
/// more easily. The result depends on nothing else, and changes smoothly with the angles, so that
/// nothing jumps when a pinch begins or ends. Angles that are not finite are returned as they are.
/// Wait-free, no allocation.
NENDO_API JointAngles close_pinches(const JointAngles& angles, const HandSkeleton& skeleton,
                                    SensorMask present, SensorMask left_out = {}) noexcept;

} // namespace nendo::hand
