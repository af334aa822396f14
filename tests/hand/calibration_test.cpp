#include <nendo/hand/calibration.hpp>

#include <initializer_list>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

namespace calibration_test {

using namespace nendo;
using namespace nendo::hand;

TEST_SUITE("calibration") {
  TEST_CASE("the angle is gain times the distance from the offset") {
    const SensorCalibration sensor{0.02, 100.0};
    CHECK(sensor.angle_rad(RawCount{100}) == doctest::Approx(0.0));
    CHECK(sensor.angle_rad(RawCount{150}) == doctest::Approx(1.0));
    CHECK(sensor.angle_rad(RawCount{50}) == doctest::Approx(-1.0));
  }

  TEST_CASE("an angle is its own line and what is mixed in of others' lines, not of their angles") {
    Calibration calibration = default_calibration();
    for (std::size_t k = 0; k < couplings.size(); ++k)
      calibration.coupling_gains[k] = 0.1 * static_cast<double>(k + 1);
    GloveSample sample;
    sample.present = sensors_22;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      sample.raw[slot] = RawCount{static_cast<std::uint16_t>(60 + 7 * slot)};
    const auto line = [&](Sensor sensor) { return calibration[sensor].angle_rad(sample[sensor]); };
    const SensorAngles angles = calibration.angles_rad(sample);
    const auto angle = [&](Sensor sensor) { return angles[static_cast<std::size_t>(sensor)]; };
    CHECK(angle(Sensor::thumb_roll) ==
          doctest::Approx(line(Sensor::thumb_roll) + 0.1 * line(Sensor::thumb_abduction)));
    CHECK(angle(Sensor::thumb_abduction) ==
          doctest::Approx(line(Sensor::thumb_abduction) + 0.2 * line(Sensor::thumb_roll)));
    CHECK(angle(Sensor::ring_little_abduction) ==
          doctest::Approx(line(Sensor::ring_little_abduction) + 0.7 * line(Sensor::ring_mcp) +
                          0.8 * line(Sensor::little_mcp)));
    CHECK(angle(Sensor::index_dip) == line(Sensor::index_dip));
    CHECK(angle(Sensor::index_abduction) == 0.0); // no glove has it
  }

  TEST_CASE("a sensor that is absent is zero and mixes into no other") {
    Calibration calibration = default_calibration();
    calibration.coupling_gains.fill(1.0);
    GloveSample sample;
    sample.raw.fill(RawCount{200});
    sample.present = sensors_22;
    sample.present.bits &= ~(1U << static_cast<unsigned>(Sensor::thumb_roll));
    const SensorAngles angles = calibration.angles_rad(sample);
    CHECK(angles[static_cast<std::size_t>(Sensor::thumb_roll)] == 0.0);
    CHECK(angles[static_cast<std::size_t>(Sensor::thumb_abduction)] ==
          calibration[Sensor::thumb_abduction].angle_rad(RawCount{200}));
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
    CHECK(reaches(Sensor::little_dip, 0, 80));
    CHECK(reaches(Sensor::thumb_roll, 0, 75));
    CHECK(reaches(Sensor::thumb_abduction, 0, 50));
    CHECK(reaches(Sensor::ring_little_abduction, 0, 30));
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

  TEST_CASE(
      "a whole range runs from the straight joint to the fully bent one, whatever its counts") {
    constexpr double rad = std::numbers::pi / 180.0;
    for (const std::uint16_t most :
         std::initializer_list<std::uint16_t>{1, 255, 1000, 1023, 4095, 65535}) {
      const Calibration calibration = default_calibration({most, true});
      const auto spans = [&](Sensor sensor, double low_deg, double high_deg) {
        CAPTURE(name_of(sensor));
        CHECK(calibration[sensor].angle_rad(RawCount{0}) == doctest::Approx(low_deg * rad));
        CHECK(calibration[sensor].angle_rad(RawCount{most}) == doctest::Approx(high_deg * rad));
      };
      spans(Sensor::index_mcp, 0, 90);
      spans(Sensor::middle_pip, 0, 100);
      spans(Sensor::little_dip, 0, 80);
      spans(Sensor::thumb_mcp, 0, 55);
      spans(Sensor::thumb_ip, 0, 80);
      spans(Sensor::index_middle_abduction, 0, 25);
      spans(Sensor::wrist_pitch, -70, 80);
    }
  }

  TEST_CASE("a finer converter of the same sensors gives the same angles") {
    const Calibration coarse = default_calibration({255, false});
    const Calibration fine = default_calibration({4095, false});
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      for (const std::uint16_t count : std::initializer_list<std::uint16_t>{0, 1, 60, 128, 255}) {
        const RawCount same{static_cast<std::uint16_t>(count * 4095 / 255)};
        if (same.value * 255 != count * 4095) continue; // no whole count corresponds
        CHECK(fine.sensors[slot].angle_rad(same) ==
              doctest::Approx(coarse.sensors[slot].angle_rad(RawCount{count})));
      }
    }
    CHECK(fine[Sensor::index_mcp].gain_rad_per_count == doctest::Approx(0.0125 * 255.0 / 4095.0));
  }

  TEST_CASE("a scale without counts has no angle") {
    for (const bool self_calibrated : {false, true}) {
      for (const auto& sensor : default_calibration({0, self_calibrated}).sensors)
        CHECK(sensor.angle_rad(RawCount{65535}) == 0.0);
    }
  }

  TEST_CASE("the little finger's sensors are also found by their older names") {
    const std::string older = "pinky";
    CHECK(sensor_named(older + "_mcp") == Sensor::little_mcp);
    CHECK(sensor_named(older + "_pip") == Sensor::little_pip);
    CHECK(sensor_named(older + "_dip") == Sensor::little_dip);
    CHECK(sensor_named("ring_" + older + "_abduction") == Sensor::ring_little_abduction);
    for (const char* const none : {"", "_", "_mc", "_mcp_", "_abduction"})
      CHECK_FALSE(sensor_named(older + none));
    CHECK_FALSE(sensor_named("index_" + older + "_abduction"));
  }

  TEST_CASE("a mask's sensors are visited in the order of their slots") {
    std::vector<Sensor> seen;
    for (const Sensor sensor : SensorMask{0xFF800081})
      seen.push_back(sensor);
    CHECK(seen == std::vector{Sensor::thumb_roll, Sensor::index_abduction, Sensor::unused});
    for ([[maybe_unused]] const Sensor sensor : SensorMask{})
      FAIL("empty");
  }
}

} // namespace calibration_test
