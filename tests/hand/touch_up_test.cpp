// A touch-up: what is left of slips after flat hand, fist and pinches, and after a free motion.

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "support/held_poses.hpp"

namespace touch_up_test {

using namespace nendo;
using namespace nendo::hand;
using namespace nendo::test;

namespace {

Calibration slipped_from(const Calibration& truth) {
  Calibration slipped = truth;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    slipped.sensors[slot].offset_counts += slot % 2 == 0 ? 9.0 : -9.0;
  return slipped;
}

FitOptions touch_up_of(const Calibration& start) {
  FitOptions options;
  options.mode = FitMode::touch_up;
  options.start = start;
  return options;
}

std::vector<PoseReading> touch_up_readings(const Calibration& of, double scatter_rad,
                                           std::mt19937& random) {
  const HandSkeleton skeleton(Side::right);
  std::normal_distribution<double> off(0.0, 1.0);
  std::vector<PoseReading> readings;
  for (const PoseId id : touch_up_poses()) {
    SensorAngles angles = pose_of(id).touch ? touching(id, skeleton) : exact(id, random);
    if (!pose_of(id).touch)
      for (double& angle : angles)
        angle += scatter_rad * off(random);
    readings.push_back({id, held(angles, of)});
  }
  return readings;
}

/// The ends of joints that go from -40 to 110 degrees, but stop so far before either end.
CountRanges ends_of(const Calibration& calibration, double short_rad) {
  CountRanges ends;
  ends.present = sensors_22;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto [gain, offset] = calibration.sensors[slot];
    if (gain == 0.0) continue;
    ends.low_counts[slot] = offset + (-40.0 * rad + short_rad) / gain;
    ends.high_counts[slot] = offset + (110.0 * rad - short_rad) / gain;
  }
  return ends;
}

} // namespace

TEST_SUITE("touch_up") {
  TEST_CASE("a touch-up finds slips, keeps gains, and does not take scatter for slips") {
    const Calibration truth = some_truth(36);
    std::mt19937 random(37);
    FitOptions options = touch_up_of(truth);
    const Calibration slipped = slipped_from(truth);
    const auto far = touch_up_readings(slipped, 0.0, random);
    const Calibration corrected = fitted(far, options);
    for (std::size_t slot = 4; slot < sensor_slots; ++slot) {
      if (truth.sensors[slot].gain_rad_per_count == 0.0) continue;
      CHECK(corrected.sensors[slot].gain_rad_per_count == truth.sensors[slot].gain_rad_per_count);
      if (slot % 4 == 3 || slot >= 20) continue; // what these poses do not ask for
      CHECK(std::abs(corrected.sensors[slot].offset_counts - slipped.sensors[slot].offset_counts) <
            4.5);
    }
    const auto scattered = touch_up_readings(truth, 4.0 * rad, random);
    CHECK(largest_difference_rad(fitted(scattered, options), truth, scattered) < 4.0 * rad);
  }

  TEST_CASE("a touch-up believes ends that have moved together, and none that moved otherwise") {
    const Calibration truth = some_truth(38);
    std::mt19937 random(39);
    const Calibration slipped = slipped_from(truth);
    const auto readings = touch_up_readings(slipped, 4.0 * rad, random);
    FitOptions options = touch_up_of(truth);
    const auto largest_slip_left = [&](const Calibration& corrected) {
      double largest = 0.0;
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        if (truth.sensors[slot].gain_rad_per_count == 0.0 || is_gap(static_cast<Sensor>(slot)))
          continue;
        largest = std::max(largest, std::abs(corrected.sensors[slot].offset_counts -
                                             slipped.sensors[slot].offset_counts));
      }
      return largest;
    };
    const Calibration by_poses = fitted(readings, options);
    CHECK(largest_slip_left(by_poses) > 4.0); // which no pose of these shows, as of a wrist
    options.start_ends = ends_of(truth, 0.0);
    CHECK(fitted(readings, options).sensors == by_poses.sensors);
    options.free_motion = ends_of(slipped, 0.0);
    CHECK(largest_slip_left(fitted(readings, options)) < 2.0);
    options.free_motion = ends_of(slipped, 2.0 * rad);
    CHECK(largest_slip_left(fitted(readings, options)) < 3.0);

    // Who went less far at both ends says little, and who moved in half of the range nothing.
    options.free_motion = ends_of(slipped, 30.0 * rad);
    const Calibration by_less = fitted(readings, options);
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      CHECK(std::abs(by_less.sensors[slot].offset_counts - by_poses.sensors[slot].offset_counts) <
            1.5);
    options.free_motion = ends_of(slipped, 40.0 * rad);
    CHECK(fitted(readings, options).sensors == by_poses.sensors);
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      options.start_ends = ends_of(truth, 0.0);
      options.free_motion = ends_of(slipped, 0.0);
      options.free_motion.low_counts.fill(bad);
      CHECK(fitted(readings, options).sensors == by_poses.sensors);
      options.free_motion = ends_of(slipped, 0.0);
      options.start_ends.high_counts.fill(bad);
      CHECK(fitted(readings, options).sensors == by_poses.sensors);
    }
  }
}

} // namespace touch_up_test
