#pragma once
// The measurements of a glove on a hand in a given pose.

#include <nendo/hand/calibration.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::motions {

/// Returns the angles of all sensors; hand::joint_angles() turns them into `joints`, if the middle
/// finger does not turn aside, which no glove measures. Wait-free.
hand::SensorAngles sensor_angles_of(const hand::JointAngles& joints) noexcept;

} // namespace nendo::motions
