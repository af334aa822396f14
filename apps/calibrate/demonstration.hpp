#pragma once
// The poses of a calibration as a wearer takes them.

#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::calibrate {

/// Returns the angles of a pose. Joints that it leaves open are relaxed. Inverse kinematics brings
/// touching tips of this hand together, which takes too long to do for every picture.
hand::JointAngles demonstrated_angles(hand::PoseId pose, const hand::HandSkeleton& skeleton);

/// Returns an average hand in that pose.
hand::HandPose demonstrated(hand::PoseId pose, Side side);

} // namespace nendo::calibrate
