#include <nendo/hand/calibration.hpp>

#include <numbers>

#include <doctest/doctest.h>

using namespace nendo;
using namespace nendo::hand;

TEST_SUITE("calibration") {
  TEST_CASE("the angle is gain times the distance from the offset") {
    const SensorCalibration sensor{0.02, 100.0};
    CHECK(sensor.angle_rad(RawCount{100}) == doctest::Approx(0.0));
    CHECK(sensor.angle_rad(RawCount{150}) == doctest::Approx(1.0));
    CHECK(sensor.angle_rad(RawCount{50}) == doctest::Approx(-1.0));
  }

  TEST_CASE("the default covers every joint's range of motion within 8 bits") {
    const Calibration calibration = default_calibration();
    const auto reaches = [&](Sensor sensor, double low_deg, double high_deg) {
      constexpr double rad = std::numbers::pi / 180.0;
      return calibration[sensor].angle_rad(RawCount{1}) <= low_deg * rad &&
             calibration[sensor].angle_rad(RawCount{255}) >= high_deg * rad;
    };
    CHECK(reaches(Sensor::index_mcp, -20, 90));
    CHECK(reaches(Sensor::middle_pip, 0, 105));
    CHECK(reaches(Sensor::pinky_dip, 0, 80));
    CHECK(reaches(Sensor::thumb_roll, 0, 75));
    CHECK(reaches(Sensor::thumb_abduction, 0, 50));
    CHECK(reaches(Sensor::ring_pinky_abduction, 0, 30));
    CHECK(reaches(Sensor::wrist_pitch, -70, 70));
    CHECK(reaches(Sensor::wrist_yaw, -30, 25));
  }

  TEST_CASE(
      "the default has a gain for every sensor that a 22-sensor glove has, and for no other") {
    const Calibration calibration = default_calibration();
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      const auto sensor = static_cast<Sensor>(slot);
      CHECK((calibration[sensor].gain_rad_per_count > 0.0) == sensors_22.has(sensor));
    }
  }
}
