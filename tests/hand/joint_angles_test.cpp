#include <nendo/hand/joint_angles.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

using namespace nendo;
using namespace nendo::hand;

namespace {

GloveSample flat_sample(SensorMask mask) {
  GloveSample sample;
  sample.present = mask;
  const Calibration calibration = default_calibration();
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    sample.raw[slot].value = static_cast<std::uint16_t>(calibration.sensors[slot].offset_counts);
  }
  return sample;
}

void set(GloveSample& sample, Sensor sensor, int counts_above_flat) {
  auto& raw = sample.raw[static_cast<std::size_t>(sensor)].value;
  raw = static_cast<std::uint16_t>(raw + counts_above_flat);
}

bool all_finite(const JointAngles& angles) {
  bool finite = std::isfinite(angles.thumb_roll_rad) && std::isfinite(angles.thumb_abduction_rad) &&
                std::isfinite(angles.thumb_mcp_flexion_rad) &&
                std::isfinite(angles.thumb_ip_flexion_rad) && std::isfinite(angles.palm_arch_rad) &&
                std::isfinite(angles.wrist_pitch_rad) && std::isfinite(angles.wrist_yaw_rad);
  for (const auto& finger : angles.fingers) {
    finite = finite && std::isfinite(finger.mcp_flexion_rad) &&
             std::isfinite(finger.mcp_abduction_rad) && std::isfinite(finger.pip_flexion_rad) &&
             std::isfinite(finger.dip_flexion_rad);
  }
  return finite;
}

} // namespace

TEST_SUITE("joint_angles") {
  TEST_CASE("a sample at the offsets is the flat hand") {
    const JointAngles angles = joint_angles(flat_sample(sensors_22), default_calibration());
    CHECK(angles.thumb_roll_rad == 0.0);
    for (const auto& finger : angles.fingers) {
      CHECK(finger.mcp_flexion_rad == 0.0);
      CHECK(finger.mcp_abduction_rad == 0.0);
      CHECK(finger.pip_flexion_rad == 0.0);
      CHECK(finger.dip_flexion_rad == 0.0);
    }
  }

  TEST_CASE("every sensor of a 22-sensor glove moves the joint that it is named after") {
    const Calibration calibration = default_calibration();
    const auto angle_after = [&](Sensor sensor, auto member) {
      GloveSample sample = flat_sample(sensors_22);
      set(sample, sensor, 8);
      return member(joint_angles(sample, calibration));
    };
    const double step = 8 * 0.0125;
    CHECK(angle_after(Sensor::thumb_mcp, [](const JointAngles& a) {
            return a.thumb_mcp_flexion_rad;
          }) == doctest::Approx(step));
    CHECK(angle_after(Sensor::thumb_abduction, [](const JointAngles& a) {
            return a.thumb_abduction_rad;
          }) == doctest::Approx(step));
    CHECK(angle_after(Sensor::ring_pip, [](const JointAngles& a) {
            return a[Finger::ring].pip_flexion_rad;
          }) == doctest::Approx(step));
    CHECK(angle_after(Sensor::pinky_dip, [](const JointAngles& a) {
            return a[Finger::little].dip_flexion_rad;
          }) == doctest::Approx(step));
    CHECK(angle_after(Sensor::wrist_yaw, [](const JointAngles& a) { return a.wrist_yaw_rad; }) ==
          doctest::Approx(step));
  }

  TEST_CASE("the pairs of abduction sensors spread the fingers away from the middle one") {
    GloveSample sample = flat_sample(sensors_22);
    set(sample, Sensor::index_middle_abduction, 20);
    set(sample, Sensor::middle_ring_abduction, 15);
    set(sample, Sensor::ring_pinky_abduction, 10);
    const JointAngles angles = joint_angles(sample, default_calibration());
    CHECK(angles[Finger::index].mcp_abduction_rad == doctest::Approx(0.20));
    CHECK(angles[Finger::middle].mcp_abduction_rad == 0.0);
    CHECK(angles[Finger::ring].mcp_abduction_rad == doctest::Approx(-0.15));
    CHECK(angles[Finger::little].mcp_abduction_rad == doctest::Approx(-0.25));
  }

  TEST_CASE("an 18-sensor glove's DIP joints follow the PIP joints") {
    GloveSample sample = flat_sample(sensors_18);
    set(sample, Sensor::middle_pip, 80); // 1 rad
    const JointAngles angles = joint_angles(sample, default_calibration());
    CHECK(angles[Finger::middle].dip_flexion_rad == doctest::Approx(0.32 + 0.17));
    CHECK(angles[Finger::index].dip_flexion_rad == 0.0);
  }

  TEST_CASE("a glove without any sensor is the flat hand") {
    const JointAngles angles = joint_angles(flat_sample(SensorMask{0}), default_calibration());
    CHECK(angles.wrist_pitch_rad == 0.0);
    CHECK(angles[Finger::index].mcp_flexion_rad == 0.0);
  }

  TEST_CASE(
      "whatever the counts and however broken the calibration, angles are finite and possible") {
    std::mt19937 random(5);
    constexpr double strange[] = {0.0,
                                  -1.0,
                                  1e300,
                                  -1e300,
                                  std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::quiet_NaN()};
    for (int round = 0; round < 2000; ++round) {
      GloveSample sample;
      sample.present.bits = static_cast<std::uint32_t>(random());
      Calibration calibration = default_calibration();
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        sample.raw[slot].value = static_cast<std::uint16_t>(random());
        if (random() % 3 == 0) calibration.sensors[slot].gain_rad_per_count = strange[random() % 6];
        if (random() % 3 == 0) calibration.sensors[slot].offset_counts = strange[random() % 6];
      }
      const JointAngles angles = joint_angles(sample, calibration);
      REQUIRE(all_finite(angles));
      for (const auto& finger : angles.fingers) {
        REQUIRE(std::abs(finger.mcp_flexion_rad) < 1.8);
        REQUIRE(std::abs(finger.pip_flexion_rad) < 2.1);
      }
    }
  }
}
