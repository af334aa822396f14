#pragma once
// How far off the angles of a calibrated glove are likely to be, so that users of a pose know
// how accurate it is. What is measured is off by a few degrees, always alike. What is estimated can
// be far off: an estimate of a DIP joint knows how far the PIP joint bends, and not whether the
// finger makes a hook.

#include <array>

#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::hand {

/// One standard deviation of each angle, by index_of(Angle), in radians; 0 where nothing is known,
/// because the angle is only assumed.
using AngleDeviations = std::array<double, angle_count>;

/// Returns what to expect of `angles`, which joint_angles() has made of a calibrated glove that has
/// these sensors, some of them perhaps `left_out`. The figures are those of strangers for tuning
/// (CALIBRATION-EVIDENCE.md): the median error of each group, as that of a normal distribution; a
/// DIP joint's by how far its PIP joint bends, least at 40 to 65 degrees; of other estimates by
/// those of the joint that they rest on, and assumed. Finite. Wait-free.
NENDO_API AngleDeviations angle_deviations(const JointAngles& angles, SensorMask present,
                                           SensorMask left_out = {}) noexcept;

} // namespace nendo::hand
