#pragma once
// Synthetic wearers of a 22-sensor glove, whose true joints and sensors are known. They differ from
// the calibration's assumptions as much as published gloves differ from each other: their gains,
// offsets and habits have other means, wider spreads and other distributions.

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

/// The motion of a wearer who moves freely: every joint goes to and fro over nearly its whole
/// range, each at its own pace.
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
  /// Makes the same wearer for the same seed. Odd seeds are left hands.
  explicit Wearer(std::uint64_t seed);

  Side side() const noexcept { return side_; }
  hand::HandSize size() const noexcept { return size_; }
  const Ranges& ranges() const noexcept { return ranges_; }
  /// Returns the true lines and couplings. Each sensor also deviates from its line by up to a
  /// degree.
  const hand::Calibration& truth() const noexcept { return truth_; }

  /// Returns the joints as this wearer holds them when asked for a pose. They are off by habit and
  /// by chance, differently each time. Pads that shall touch do so, except that they slip by a few
  /// millimetres. Poses against a table are as exact as a flat hand, with a habit of their own
  /// where the hand bends over the edge.
  hand::SensorAngles perform(hand::PoseId pose);
  /// Returns the glove's counts, noisy and rounded to 8 bits.
  GloveSample read(const hand::SensorAngles& angles_rad);
  /// Returns how far apart the pads are that shall touch in `pose`.
  double gap_m(hand::PoseId pose, const hand::SensorAngles& angles_rad) const;

private:
  double clamped(std::size_t slot, double angle_rad) const;
  double normal(double mean, double deviation);
  double uniform(double low, double high);
  void draw_sensors();
  void make_touch(hand::PoseId pose, hand::SensorAngles& angles);
  /// Makes one step of the joints that bring the pads together.
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
  /// The habit against an edge, where flesh gives way. It is as large as other habits, but
  /// independent of them.
  std::array<double, sensor_slots> edge_habit_rad_{};
  double pad_depth_m_ = 0.0;
  double pad_behind_tip_m_ = 0.0;
  double palm_depth_m_ = 0.0;
};

/// Returns the joint angles for these sensors' angles, with a straight middle finger.
hand::JointAngles joints_of(const hand::SensorAngles& angles_rad) noexcept;

} // namespace nendo::reference
