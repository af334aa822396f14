#pragma once
// Hands in random poses, at random places.

#include <random>

#include <Eigen/Geometry>

#include <nendo/hand/joint_angles.hpp>

namespace nendo::test {

inline hand::JointAngles random_angles(std::mt19937& random) {
  std::uniform_real_distribution<double> bend(-0.3, 2.0);
  std::uniform_real_distribution<double> spread(-0.3, 0.6);
  hand::JointAngles angles;
  angles.thumb_roll_rad = bend(random);
  angles.thumb_abduction_rad = spread(random);
  angles.thumb_mcp_flexion_rad = bend(random);
  angles.thumb_ip_flexion_rad = bend(random);
  for (auto& finger : angles.fingers)
    finger = {bend(random), spread(random), bend(random), bend(random)};
  angles.palm_arch_rad = spread(random);
  angles.wrist_pitch_rad = spread(random);
  angles.wrist_yaw_rad = spread(random);
  return angles;
}

inline Eigen::Isometry3d random_place(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.linear() = q.normalized().toRotationMatrix();
  place.translation() = Eigen::Vector3d(normal(random), normal(random), normal(random));
  return place;
}

} // namespace nendo::test
