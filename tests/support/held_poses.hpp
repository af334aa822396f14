#pragma once
// Calibration poses held by a hand whose calibration is known: exactly as asked, with loops that
// close.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include <nendo/hand/calibration_fit.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::test {

using namespace nendo::hand;

inline constexpr double rad = std::numbers::pi / 180.0;
inline constexpr std::size_t roll = 0, web = 3; // the thumb's abduction

constexpr std::size_t slot_of(Sensor sensor) {
  return static_cast<std::size_t>(sensor);
}

/// Returns gains up to a quarter above the default, and offsets up to 12 counts off it.
inline Calibration some_truth(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  Calibration truth = default_calibration();
  for (auto& [gain, offset] : truth.sensors) {
    gain *= 1.1 + 0.15 * u(random);
    offset += 12.0 * u(random);
  }
  truth.coupling_gains = {0.3, -0.2, -0.1, -0.2, -0.15, 0.05, -0.2, -0.1};
  return truth;
}

/// Returns the counts, not rounded, for which `truth` gives these angles. It inverts the couplings.
inline std::array<double, sensor_slots> counts_at(const SensorAngles& angles,
                                                  const Calibration& truth) {
  SensorAngles lines = angles;
  for (std::size_t k = 2; k < couplings.size(); ++k)
    lines[slot_of(couplings[k].of)] -= truth.coupling_gains[k] * angles[slot_of(couplings[k].by)];
  const double a = truth.coupling_gains[0], b = truth.coupling_gains[1];
  lines[roll] = (angles[roll] - a * angles[web]) / (1.0 - a * b);
  lines[web] = (angles[web] - b * angles[roll]) / (1.0 - a * b);
  std::array<double, sensor_slots> counts{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto [gain, offset] = truth.sensors[slot];
    if (gain == 0.0) continue;
    counts[slot] = lines[slot] / gain + offset;
    REQUIRE(counts[slot] > 1.0);
    REQUIRE(counts[slot] < 255.0);
  }
  return counts;
}

/// Returns the angles that the pose asks for, and random ones where it asks for nothing.
inline SensorAngles exact(PoseId id, std::mt19937& random) {
  std::uniform_real_distribution<double> u(0.1, 0.6);
  SensorAngles angles{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const AssumedAngle& assumed = pose_of(id).assumed[slot];
    angles[slot] = assumed.known() ? assumed.angle_rad : u(random);
  }
  return angles;
}

inline HeldPose held(const SensorAngles& angles, const Calibration& truth,
                     SensorMask sensors = sensors_22) {
  HeldPose pose;
  pose.present = sensors;
  pose.mean_counts = counts_at(angles, truth);
  return pose;
}

inline SensorAngles touching(PoseId id, const HandSkeleton& skeleton);

/// Returns readings with loops that close. More `times` give more evidence, so that the default's
/// influence vanishes.
inline std::vector<PoseReading> exact_readings(const Calibration& truth, int times = 1) {
  const HandSkeleton skeleton(Side::right);
  std::mt19937 random(4);
  std::vector<PoseReading> readings;
  for (int n = 0; n < times; ++n) {
    for (const PoseId id : full_poses()) {
      const bool touch = pose_of(id).touch.has_value();
      readings.push_back({id, held(touch ? touching(id, skeleton) : exact(id, random), truth)});
    }
  }
  return readings;
}

inline std::vector<PoseReading> quick_readings(const Calibration& truth) {
  std::vector<PoseReading> readings = exact_readings(truth);
  readings.resize(2);
  return readings;
}

inline Calibration fitted(const std::vector<PoseReading>& readings, const FitOptions& options = {},
                          Side side = Side::right) {
  const auto fit = fit_calibration(readings, side, sensors_22, options);
  REQUIRE_MESSAGE(fit, (fit ? "" : fit.error().message));
  return fit->calibration;
}

/// Returns the largest difference of any angle between the two calibrations, over the range of
/// counts that the readings cover.
inline double largest_difference_rad(const Calibration& a, const Calibration& b,
                                     const std::vector<PoseReading>& readings) {
  double largest = 0.0;
  for (const auto& reading : readings) {
    GloveSample sample;
    sample.present = sensors_22;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      sample.raw[slot].value = static_cast<std::uint16_t>(reading.held.mean_counts[slot]);
    const SensorAngles of_a = a.angles_rad(sample), of_b = b.angles_rad(sample);
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      largest = std::max(largest, std::abs(of_a[slot] - of_b[slot]));
  }
  return largest;
}

/// Returns the angles that bring the pads together, by Newton's steps on the forward kinematics.
/// Only the thumb touches the palm at the little finger's base.
inline SensorAngles touching(PoseId id, const HandSkeleton& skeleton) {
  const Touch& touch = *pose_of(id).touch;
  const auto tip = std::find(fingertips.begin(), fingertips.end(), touch.with);
  const bool palm = tip == fingertips.end();
  const auto gap = [&](const SensorAngles& at) -> Eigen::Vector3d {
    JointAngles joints;
    joints.thumb_roll_rad = at[0];
    joints.thumb_mcp_flexion_rad = at[1];
    joints.thumb_ip_flexion_rad = at[2];
    joints.thumb_abduction_rad = at[3];
    joints.palm_arch_rad = at[slot_of(Sensor::palm_arch)];
    for (std::size_t f = 0; f < 4; ++f)
      joints.fingers[f] = {at[4 * f + 4], 0.0, at[4 * f + 5], at[4 * f + 6]};
    const HandPose pose = skeleton.pose(joints, Eigen::Isometry3d::Identity());
    const Eigen::Vector3d thumb = pose[Joint::thumb_tip] * skeleton.pad();
    if (!palm) return thumb - pose[touch.with] * skeleton.pad();
    return thumb - pose[touch.with].translation() -
           pose[Joint::little_metacarpal].linear() * Eigen::Vector3d(0, -palm_depth_m, 0);
  };
  SensorAngles angles{};
  const std::size_t finger = palm ? 0 : static_cast<std::size_t>(tip - fingertips.begin());
  angles[roll] = (palm ? 45.0 : 60.0 + 4.0 * static_cast<double>(finger)) * rad;
  angles[web] = (palm ? 10.0 : 35.0) * rad;
  angles[1] = angles[2] = palm ? 45.0 * rad : (15.0 + 8.0 * static_cast<double>(finger)) * rad;
  for (std::size_t f = 0; f < 4 && !palm; ++f) {
    angles[4 * f + 4] = angles[4 * f + 5] = 45.0 * rad;
    angles[4 * f + 6] = 25.0 * rad;
  }
  const auto& assumed = pose_of(id).assumed;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (assumed[slot].known()) angles[slot] = assumed[slot].angle_rad;
  std::vector<std::size_t> moved{0, 1, 2, 3};
  for (const std::size_t slot : {4 * finger, 4 * finger + 1})
    if (!palm && !assumed[slot].known()) moved.push_back(slot);
  for (int turn = 0; turn < 100; ++turn) {
    const Eigen::Vector3d apart = gap(angles);
    Eigen::Matrix<double, 3, Eigen::Dynamic> slopes(3, static_cast<Eigen::Index>(moved.size()));
    for (std::size_t n = 0; n < moved.size(); ++n) {
      SensorAngles next = angles;
      next[moved[n]] += 1e-6;
      slopes.col(static_cast<Eigen::Index>(n)) = (gap(next) - apart) / 1e-6;
    }
    const Eigen::Matrix3d square = slopes * slopes.transpose() + 1e-7 * Eigen::Matrix3d::Identity();
    const Eigen::VectorXd step = slopes.transpose() * (square.inverse() * apart);
    for (std::size_t n = 0; n < moved.size(); ++n)
      angles[moved[n]] -= 0.5 * step[static_cast<Eigen::Index>(n)];
  }
  REQUIRE(gap(angles).norm() < 1e-4);
  return angles;
}

} // namespace nendo::test
