#pragma once
// A hand that pinches, in counts of a glove.

#include <nendo/hand/inverse_kinematics.hpp>

#include "support/flow_fixtures.hpp"

namespace nendo::test {

/// Counts of a hand whose thumb is some millimetres from its index finger, as the default
/// calibration reads them.
inline GloveSample pinching_sample(Side side, HostTime now) {
  const hand::HandSkeleton skeleton(side);
  hand::JointAngles start;
  start.thumb_roll_rad = 0.8;
  start.thumb_abduction_rad = 0.6;
  start[hand::Finger::index] = {0.8, 0.1, 0.8, 0.4};
  hand::FingertipTargets targets{};
  targets[0].weight = 1.0;
  targets[0].position_m =
      skeleton.pose(start, Eigen::Isometry3d::Identity())[hand::Joint::index_tip].translation();
  const hand::JointAngles pinch =
      hand::inverse_kinematics(skeleton, Eigen::Isometry3d::Identity(), targets, start).angles;
  GloveSample sample = bent_sample(side, 0, now);
  const hand::Calibration calibration = hand::default_calibration();
  const auto set = [&](Sensor sensor, double angle_rad) {
    const auto& line = calibration.sensors[static_cast<std::size_t>(sensor)];
    sample.set(sensor, RawCount{static_cast<std::uint16_t>(line.offset_counts +
                                                           angle_rad / line.gain_rad_per_count)});
  };
  set(Sensor::thumb_roll, pinch.thumb_roll_rad);
  set(Sensor::thumb_abduction, pinch.thumb_abduction_rad);
  set(Sensor::thumb_mcp, pinch.thumb_mcp_flexion_rad);
  set(Sensor::thumb_ip, pinch.thumb_ip_flexion_rad);
  set(Sensor::index_mcp, pinch[hand::Finger::index].mcp_flexion_rad);
  set(Sensor::index_pip, pinch[hand::Finger::index].pip_flexion_rad);
  set(Sensor::index_dip, pinch[hand::Finger::index].dip_flexion_rad);
  return sample;
}

/// Where the wrist is if such a hand's thumb and index finger meet there; metres.
inline Eigen::Isometry3d wrist_pinching_at(Side side, const Eigen::Vector3d& place_m) {
  const auto angles =
      hand::joint_angles(pinching_sample(side, HostClock::now()), hand::default_calibration());
  const auto pose = hand::HandSkeleton(side).pose(angles, Eigen::Isometry3d::Identity());
  return Eigen::Isometry3d(
      Eigen::Translation3d(place_m - pose[hand::Joint::thumb_tip].translation()));
}

} // namespace nendo::test
