#include "calibrate/demonstration.hpp"

#include <algorithm>
#include <cmath>

#include <nendo/hand/inverse_kinematics.hpp>

namespace nendo::calibrate {
namespace {

using hand::Joint;
using hand::JointAngles;

/// Returns the angles that a pose assumes, as a glove would measure them. Joints that the pose
/// leaves open are relaxed.
JointAngles assumed_angles(const hand::CalibrationPose& pose) {
  constexpr double gain = 1e-4; // rad: finer than any eye
  constexpr double offset = 30000.0;
  constexpr double relaxed_thumb_rad = 0.35;
  hand::Calibration calibration;
  calibration.sensors.fill({gain, offset});
  GloveSample sample;
  for (const Sensor sensor : sensors_22) {
    const std::size_t slot = index_of(sensor);
    double angle_rad = pose.assumed[slot].known() ? pose.assumed[slot].angle_rad : 0.0;
    const bool opposes = sensor == Sensor::thumb_roll || sensor == Sensor::thumb_abduction;
    if (opposes && !pose.assumed[slot].known()) angle_rad = relaxed_thumb_rad;
    sample.set(sensor,
               RawCount{static_cast<std::uint16_t>(std::lround(offset + angle_rad / gain))});
  }
  return hand::joint_angles(sample, calibration);
}

/// Brings the pads of the thumb and of the finger with the tip `with` together. It begins with a
/// half closed hand or, if the pose asks for a `straight` finger, with one that is bent at its base
/// alone. If `with` is no fingertip, it lays the thumb's pad on the palm at that joint.
JointAngles touching(JointAngles angles, Joint with, bool straight,
                     const hand::HandSkeleton& skeleton) {
  const Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d& pad = skeleton.pad();
  const auto found = std::find(hand::fingertips.begin(), hand::fingertips.end(), with);
  const bool palm = found == hand::fingertips.end();
  const auto finger = palm ? 0 : static_cast<std::size_t>(found - hand::fingertips.begin());
  angles.thumb_roll_rad = palm ? 0.8 : 1.2;
  angles.thumb_abduction_rad = palm ? 0.2 : 0.6;
  angles.thumb_mcp_flexion_rad = palm ? 0.8 : 0.2 * static_cast<double>(finger);
  angles.thumb_ip_flexion_rad = palm ? 0.8 : 0.2;
  if (!palm)
    angles.fingers[finger - 1] =
        straight ? hand::FingerAngles{1.0, 0.0, 0.2, 0.1} : hand::FingerAngles{0.9, 0.0, 0.8, 0.4};
  for (int turn = 0; turn < 10; ++turn) { // tips turn as they move
    const hand::HandPose pose = skeleton.pose(angles, origin);
    const Eigen::Isometry3d& thumb = pose[Joint::thumb_tip];
    const Eigen::Isometry3d& other = pose[with];
    const Eigen::Vector3d meets =
        palm ? other * Eigen::Vector3d(0.0, -hand::palm_depth_m, 0.0) : other * pad;
    const Eigen::Vector3d gap = meets - thumb * pad;
    hand::FingertipTargets targets{};
    targets[0] = {thumb.translation() + (palm ? 1.0 : 0.5) * gap, 1.0};
    if (!palm) targets[finger] = {other.translation() - 0.5 * gap, 1.0};
    angles = hand::inverse_kinematics(skeleton, origin, targets, angles).angles;
  }
  return angles;
}

} // namespace

JointAngles demonstrated_angles(hand::PoseId id, const hand::HandSkeleton& skeleton) {
  const hand::CalibrationPose& pose = hand::pose_of(id);
  const JointAngles angles = assumed_angles(pose);
  if (!pose.touch) return angles;
  const bool straight = pose.assumed[index_of(Sensor::index_pip)].known();
  return touching(angles, pose.touch->with, straight, skeleton);
}

hand::HandPose demonstrated(hand::PoseId id, Side side) {
  // Solved as a right hand: a left one is its mirror image.
  const JointAngles angles = demonstrated_angles(id, hand::HandSkeleton(Side::right));
  return hand::HandSkeleton(side).pose(angles, Eigen::Isometry3d::Identity());
}

} // namespace nendo::calibrate
