#include <nendo/hand/joint_angles.hpp>

#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/skeleton.hpp>

namespace joint_angles_test {

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

constexpr SensorMask mask_of(std::initializer_list<Sensor> sensors) {
  SensorMask mask;
  for (const Sensor sensor : sensors)
    mask.bits |= 1U << static_cast<unsigned>(sensor);
  return mask;
}

// Gloves with fewer sensors than a CyberGlove: one a finger, at either joint, and two a finger.
constexpr SensorMask curls = mask_of({Sensor::thumb_mcp, Sensor::index_mcp, Sensor::middle_mcp,
                                      Sensor::ring_mcp, Sensor::little_mcp});
constexpr SensorMask pip_curls = mask_of({Sensor::thumb_ip, Sensor::index_pip, Sensor::middle_pip,
                                          Sensor::ring_pip, Sensor::little_pip});
constexpr SensorMask two_a_finger{curls.bits | pip_curls.bits};
constexpr SensorMask spread_alone = mask_of({Sensor::thumb_mcp, Sensor::thumb_abduction});

constexpr CountScale self_calibrated{1000, true};

GloveSample closed(SensorMask mask, std::uint16_t count) {
  GloveSample sample;
  sample.present = mask;
  sample.raw.fill(RawCount{count});
  return sample;
}

/// Every angle that a flexion sensor may move, in one row.
std::vector<double> flexions(const JointAngles& a) {
  std::vector<double> row{a.thumb_roll_rad, a.thumb_abduction_rad, a.thumb_mcp_flexion_rad,
                          a.thumb_ip_flexion_rad};
  for (const auto& finger : a.fingers)
    row.insert(row.end(), {finger.mcp_flexion_rad, finger.pip_flexion_rad, finger.dip_flexion_rad});
  return row;
}

double thumb_to_index(const JointAngles& angles) {
  const HandPose pose = HandSkeleton(Side::right).pose(angles, Eigen::Isometry3d::Identity());
  return (pose[Joint::thumb_tip].translation() - pose[Joint::index_tip].translation()).norm();
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
    CHECK(angle_after(Sensor::little_dip, [](const JointAngles& a) {
            return a[Finger::little].dip_flexion_rad;
          }) == doctest::Approx(step));
    CHECK(angle_after(Sensor::wrist_yaw, [](const JointAngles& a) { return a.wrist_yaw_rad; }) ==
          doctest::Approx(step));
  }

  TEST_CASE("the pairs of abduction sensors spread the fingers away from the middle one") {
    GloveSample sample = flat_sample(sensors_22);
    set(sample, Sensor::index_middle_abduction, 20);
    set(sample, Sensor::middle_ring_abduction, 15);
    set(sample, Sensor::ring_little_abduction, 10);
    const JointAngles angles = joint_angles(sample, default_calibration());
    CHECK(angles[Finger::index].mcp_abduction_rad == doctest::Approx(0.20));
    CHECK(angles[Finger::middle].mcp_abduction_rad == 0.0);
    CHECK(angles[Finger::ring].mcp_abduction_rad == doctest::Approx(-0.15));
    CHECK(angles[Finger::little].mcp_abduction_rad == doctest::Approx(-0.25));
  }

  TEST_CASE("the middle bias turns all fingers and leaves the gaps between them as they are") {
    GloveSample sample = flat_sample(sensors_22);
    set(sample, Sensor::index_middle_abduction, 20);
    set(sample, Sensor::middle_ring_abduction, 10);
    set(sample, Sensor::ring_little_abduction, 10);
    Calibration calibration = default_calibration();
    calibration.middle_bias = 0.5;
    const JointAngles angles = joint_angles(sample, calibration);
    CHECK(angles[Finger::middle].mcp_abduction_rad == doctest::Approx(-0.05));
    CHECK(angles[Finger::index].mcp_abduction_rad == doctest::Approx(0.15));
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

  TEST_CASE("18- and 22-sensor gloves show what they measure, and nothing is made up but the DIP") {
    // Between the soft stops what is measured is shown; beyond, something between stop and end.
    const auto shows = [](double shown, double angle_rad, std::array<double, 4> ends_deg) {
      constexpr double rad = 3.14159265358979323846 / 180.0;
      const auto [least, soft_min, soft_max, most] = ends_deg;
      if (angle_rad > soft_max * rad) return shown > soft_max * rad && shown < most * rad;
      if (angle_rad < soft_min * rad) return shown < soft_min * rad && shown > least * rad;
      return shown == doctest::Approx(angle_rad);
    };
    const Calibration calibration = default_calibration();
    std::mt19937 random(11);
    for (int round = 0; round < 500; ++round) {
      GloveSample sample;
      sample.present = round % 2 == 0 ? sensors_22 : sensors_18;
      for (auto& raw : sample.raw)
        raw.value = static_cast<std::uint16_t>(random() % 256);
      const auto angle = [&](Sensor sensor) {
        return calibration[sensor].angle_rad(sample[sensor]);
      };
      const JointAngles a = joint_angles(sample, calibration);
      CHECK(shows(a.thumb_roll_rad, angle(Sensor::thumb_roll), {-20, -10, 80, 90}));
      CHECK(shows(a.thumb_abduction_rad, angle(Sensor::thumb_abduction), {-10, -5, 60, 70}));
      CHECK(shows(a.thumb_mcp_flexion_rad, angle(Sensor::thumb_mcp), {-20, -10, 60, 70}));
      CHECK(shows(a.thumb_ip_flexion_rad, angle(Sensor::thumb_ip), {-20, -10, 80, 90}));
      CHECK(shows(a.palm_arch_rad, angle(Sensor::palm_arch), {-5, -2, 30, 35}));
      CHECK(shows(a.wrist_pitch_rad, angle(Sensor::wrist_pitch), {-75, -70, 80, 85}));
      const double index_middle = angle(Sensor::index_middle_abduction);
      const double middle_ring = angle(Sensor::middle_ring_abduction);
      const double ring_little = angle(Sensor::ring_little_abduction);
      CHECK(shows(a[Finger::index].mcp_abduction_rad, index_middle, {-15, -10, 30, 40}));
      CHECK(a[Finger::middle].mcp_abduction_rad == 0.0);
      CHECK(shows(a[Finger::little].mcp_abduction_rad, -middle_ring - ring_little,
                  {-70, -55, 20, 30}));
      const FingerAngles& ring = a[Finger::ring];
      CHECK(shows(ring.mcp_abduction_rad, -middle_ring, {-40, -30, 10, 15}));
      CHECK(shows(ring.mcp_flexion_rad, angle(Sensor::ring_mcp), {-30, -20, 90, 100}));
      CHECK(shows(ring.pip_flexion_rad, angle(Sensor::ring_pip), {-10, -5, 105, 115}));
      const double pip = ring.pip_flexion_rad;
      const double estimated = pip > 0.0 ? 0.32 * pip * pip + 0.17 * pip : 0.0;
      const double dip = round % 2 == 0 ? angle(Sensor::ring_dip) : estimated;
      CHECK(shows(ring.dip_flexion_rad, dip, {-10, -5, 80, 85}));
    }
  }

  TEST_CASE("with fewer sensors every angle follows without a jump and never backwards") {
    const Calibration calibration = default_calibration(self_calibrated);
    for (const SensorMask mask : {curls, pip_curls, two_a_finger, spread_alone}) {
      std::vector<double> before = flexions(joint_angles(closed(mask, 0), calibration));
      for (std::uint16_t count = 1; count <= self_calibrated.max_count; ++count) {
        const auto now = flexions(joint_angles(closed(mask, count), calibration));
        for (std::size_t n = 0; n < now.size(); ++n) {
          REQUIRE(now[n] >= before[n]);
          REQUIRE(now[n] - before[n] <
                  0.005);          // a thousandth of the way, three times as fast as PIP
          REQUIRE(now[n] <= 2.01); // 115 degrees, the most that any joint bends
        }
        before = now;
      }
    }
  }

  TEST_CASE("a bent finger's PIP follows the MCP 1.1 times, its DIP the PIP, and the MCP the PIP") {
    const Calibration calibration = default_calibration(self_calibrated);
    const double half_mcp = 0.5 * 1.5707963267948966;
    const FingerAngles curl = joint_angles(closed(curls, 500), calibration)[Finger::middle];
    CHECK(curl.mcp_flexion_rad == doctest::Approx(half_mcp));
    CHECK(curl.pip_flexion_rad == doctest::Approx(1.1 * half_mcp));
    const double pip = 1.1 * half_mcp;
    CHECK(curl.dip_flexion_rad == doctest::Approx(0.32 * pip * pip + 0.17 * pip));
    const FingerAngles by_pip = joint_angles(closed(pip_curls, 500), calibration)[Finger::middle];
    CHECK(by_pip.mcp_flexion_rad == doctest::Approx(by_pip.pip_flexion_rad / 1.1));
    CHECK(curl.mcp_abduction_rad == 0.0);
    // Stretching a finger backwards does not bend it further out.
    Calibration stretched = calibration;
    stretched.sensors[static_cast<std::size_t>(Sensor::middle_mcp)].offset_counts = 700;
    const FingerAngles back = joint_angles(closed(curls, 500), stretched)[Finger::middle];
    CHECK(back.mcp_flexion_rad < 0.0);
    CHECK(back.pip_flexion_rad == 0.0);
  }

  TEST_CASE("a glove of five curls makes a flat hand, a fist, and a pinch") {
    const Calibration calibration = default_calibration(self_calibrated);
    const HandSkeleton skeleton(Side::right);
    const auto fingertips = [&](std::uint16_t count) {
      return skeleton
          .pose(joint_angles(closed(curls, count), calibration), Eigen::Isometry3d::Identity())
          .fingertip_positions();
    };
    for (Eigen::Index finger = 1; finger < 5; ++finger) {
      CHECK(std::abs(fingertips(0)(1, finger)) < 0.01); // in the plane of the hand
      CHECK(-fingertips(1000)(2, finger) < 0.095);      // back at the palm, which is 83 mm long
      CHECK(fingertips(1000)(1, finger) < -0.01);       // and in front of it
    }
    double nearest = 1.0;
    for (std::uint16_t index = 0; index <= 1000; index = static_cast<std::uint16_t>(index + 10)) {
      GloveSample sample = closed(curls, 1000);
      sample.raw[static_cast<std::size_t>(Sensor::index_mcp)].value = index;
      nearest = std::min(nearest, thumb_to_index(joint_angles(sample, calibration)));
    }
    CHECK(nearest < 0.007);
    CHECK(thumb_to_index(joint_angles(closed(curls, 0), calibration)) > 0.06);
  }

  TEST_CASE("a thumb without a flexion sensor lies flat") {
    GloveSample sample = closed(curls, 1000);
    sample.present.bits &= ~mask_of({Sensor::thumb_mcp}).bits;
    const JointAngles angles = joint_angles(sample, default_calibration(self_calibrated));
    CHECK(angles.thumb_roll_rad == 0.0);
    CHECK(angles.thumb_abduction_rad == 0.0);
    CHECK(angles.thumb_mcp_flexion_rad == 0.0);
    CHECK(angles.thumb_ip_flexion_rad == 0.0);
  }

  TEST_CASE("a glove without any sensor is the flat hand") {
    const JointAngles angles = joint_angles(flat_sample(SensorMask{0}), default_calibration());
    CHECK(angles.wrist_pitch_rad == 0.0);
    CHECK(angles[Finger::index].mcp_flexion_rad == 0.0);
  }

  TEST_CASE("a joint whose sensor reads past its range still moves") {
    for (const Sensor sensor : {Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip}) {
      GloveSample sample = flat_sample(sensors_22);
      set(sample, sensor, 170); // 2.1 rad, more than any of them bends
      const FingerAngles near = joint_angles(sample, default_calibration())[Finger::ring];
      set(sample, sensor, 8);
      const FingerAngles far = joint_angles(sample, default_calibration())[Finger::ring];
      const double moved = (far.mcp_flexion_rad - near.mcp_flexion_rad) +
                           (far.pip_flexion_rad - near.pip_flexion_rad) +
                           (far.dip_flexion_rad - near.dip_flexion_rad);
      CHECK(moved > 0.001);
      CHECK(moved < 0.1);
    }
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
      for (auto& part : calibration.coupling_gains) {
        if (random() % 3 == 0) part = strange[random() % 6];
      }
      if (random() % 3 == 0) calibration.middle_bias = strange[random() % 6];
      const JointAngles angles = joint_angles(sample, calibration);
      REQUIRE(all_finite(angles));
      for (const auto& finger : angles.fingers) {
        REQUIRE(std::abs(finger.mcp_flexion_rad) < 1.8);
        REQUIRE(std::abs(finger.pip_flexion_rad) < 2.1);
        REQUIRE(std::abs(finger.mcp_abduction_rad) < 1.3);
      }
    }
  }
}

} // namespace joint_angles_test
