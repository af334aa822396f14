#pragma once
// Synthetic wearers of a 22-sensor glove, whose true joints and sensors are known. They are as
// unlike the calibration's assumptions as published gloves are unlike each other: their gains,
// offsets and habits are drawn about other means, wider, and from other shapes.

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::reference {

struct AngleRange {
  double low_rad = 0.0;
  double high_rad = 0.0;
};
using Ranges = std::array<AngleRange, sensor_slots>;

/// A wearer moving freely: every joint to and fro over nearly its whole range, none like another.
class FreeMotion {
public:
  FreeMotion(std::uint64_t seed, const Ranges& ranges);
  hand::SensorAngles angles_rad(double time_s) const;

private:
  struct Wave {
    double slow_hz, fast_hz, slow_phase, fast_phase;
  };
  std::array<Wave, sensor_slots> waves_;
  Ranges ranges_;
};

class Wearer {
public:
  /// The same wearer for the same seed; odd seeds are left hands.
  explicit Wearer(std::uint64_t seed);

  Side side() const noexcept { return side_; }
  hand::HandSize size() const noexcept { return size_; }
  const Ranges& ranges() const noexcept { return ranges_; }
  /// Lines and couplings; each sensor also bends away from its line by up to a degree.
  const hand::Calibration& truth() const noexcept { return truth_; }

  /// The joints as this wearer holds them when asked for a pose: off by habit and by chance, each
  /// time anew. Touches do touch, but for a few millimetres that pads slip. What lies against a
  /// table is as sure as a flat hand, but for a habit of its own where it is bent over the edge.
  hand::SensorAngles perform(hand::PoseId pose);
  /// The glove's counts, noisy and rounded to 8 bits.
  GloveSample read(const hand::SensorAngles& angles_rad);
  /// How far apart the pads are that touch in `pose`.
  double gap_m(hand::PoseId pose, const hand::SensorAngles& angles_rad) const;

private:
  double clamped(std::size_t slot, double angle_rad) const;
  double normal(double mean, double deviation);
  double uniform(double low, double high);
  void draw_sensors();
  void make_touch(hand::PoseId pose, hand::SensorAngles& angles);
  /// One step of the joints that bring the pads together.
  void approach(const hand::Touch& touch, const std::vector<std::size_t>& slots,
                const Eigen::Vector3d& slip_m, hand::SensorAngles& angles) const;
  Eigen::Vector3d gap(const hand::Touch& touch, const hand::SensorAngles& angles) const;
  double count_of(std::size_t slot, const hand::SensorAngles& lines) const;

  std::mt19937_64 random_;
  Side side_;
  hand::HandSize size_;
  hand::HandSkeleton skeleton_;
  Ranges ranges_{};
  hand::Calibration truth_;
  std::array<double, sensor_slots> bow_rad_{};
  std::array<double, sensor_slots> habit_rad_{};
  /// Against an edge, where flesh gives way: as large as habits are, and of another kind.
  std::array<double, sensor_slots> edge_habit_rad_{};
  double pad_depth_m_ = 0.0;
  double pad_behind_tip_m_ = 0.0;
  double palm_depth_m_ = 0.0;
};

/// The joints of these sensors' angles, with a straight middle finger.
hand::JointAngles joints_of(const hand::SensorAngles& angles_rad) noexcept;

} // namespace nendo::reference
