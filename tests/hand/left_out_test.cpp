// Angles of sensors that are left out.

#include <cmath>
#include <initializer_list>
#include <random>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "support/random_calibration.hpp"

namespace left_out_test {

using namespace nendo;
using namespace nendo::hand;

namespace {

GloveSample random_sample(std::mt19937& random, SensorMask sensors = sensors_22) {
  GloveSample sample;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (sensors.has(static_cast<Sensor>(slot)))
      sample.set(static_cast<Sensor>(slot),
                 RawCount{static_cast<std::uint16_t>(40 + random() % 160)});
  return sample;
}

SensorMask mask(std::initializer_list<Sensor> sensors) {
  SensorMask mask;
  for (const Sensor sensor : sensors)
    mask.add(sensor);
  return mask;
}

Calibration some_calibration() {
  Calibration calibration = default_calibration();
  calibration.coupling_gains = {0.3, -0.2, -0.1, -0.2, -0.15, 0.05, -0.2, -0.1};
  return calibration;
}

} // namespace

TEST_SUITE("left_out") {
  TEST_CASE("where nothing is left out, or only what is not there, angles are the same bits") {
    std::mt19937 random(1);
    const Calibration calibration = some_calibration();
    for (int n = 0; n < 200; ++n) {
      const SensorMask sensors{static_cast<std::uint32_t>(random()) & sensors_22.bits};
      const GloveSample sample = random_sample(random, sensors);
      const SensorMask absent{~sensors.bits & sensors_22.bits};
      const auto plain = joint_angles(sample, calibration);
      const auto filled = joint_angles(sample, calibration, absent);
      for (std::size_t at = 0; at < angle_count; ++at)
        CHECK(test::same_bits(plain[angle_at(at)], filled[angle_at(at)]));
      CHECK(angle_sources(sensors, absent) == angle_sources(sensors));
    }
  }

  TEST_CASE("what a sensor counts that is left out changes nothing, whichever sensors they are") {
    std::mt19937 random(2);
    const Calibration calibration = some_calibration();
    for (int n = 0; n < 500; ++n) {
      const SensorMask left_out{static_cast<std::uint32_t>(random()) &
                                static_cast<std::uint32_t>(random()) & sensors_22.bits};
      GloveSample sample = random_sample(random);
      const auto before = joint_angles(sample, calibration, left_out);
      for (std::size_t slot = 0; slot < sensor_slots; ++slot)
        if (left_out.has(static_cast<Sensor>(slot)))
          sample.raw[slot].value = static_cast<std::uint16_t>(random() % 256);
      const auto after = joint_angles(sample, calibration, left_out);
      const auto sources = angle_sources(sensors_22, left_out);
      const auto deviations = angle_deviations(after, sensors_22, left_out);
      const auto usual = angle_deviations(after, sensors_22);
      for (std::size_t at = 0; at < angle_count; ++at) {
        const double angle_rad = after[angle_at(at)];
        REQUIRE(test::same_bits(before[angle_at(at)], angle_rad));
        REQUIRE(std::isfinite(angle_rad));
        REQUIRE(std::abs(angle_rad) < 3.0);
        REQUIRE(std::isfinite(deviations[at]));
        if (sources[at] == AngleSource::measured) CHECK(deviations[at] == usual[at]);
        if (is_estimated(sources[at])) CHECK(deviations[at] > from_degrees(5.0));
      }
    }
  }

  TEST_CASE("an angle is estimated exactly if a sensor of it is left out") {
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      const auto sensor = static_cast<Sensor>(slot);
      if (!sensors_22.has(sensor)) continue;
      CAPTURE(name_of(sensor));
      const auto sources = angle_sources(sensors_22, mask({sensor}));
      const auto usual = angle_sources(sensors_22);
      int changed = 0;
      for (std::size_t at = 0; at < angle_count; ++at) {
        if (sources[at] == usual[at]) continue;
        ++changed;
        CHECK(is_estimated(sources[at]));
        CHECK(sources[at] != AngleSource::measured);
      }
      // The gap between middle and ring finger is part of two angles.
      CHECK(changed == (sensor == Sensor::middle_ring_abduction ? 2 : 1));
    }
  }

  TEST_CASE("a hand that closes evenly is estimated within twenty degrees, from any neighbour") {
    const Calibration calibration = default_calibration();
    for (const Sensor sensor : {Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip,
                                Sensor::ring_mcp, Sensor::ring_pip, Sensor::little_pip}) {
      CAPTURE(name_of(sensor));
      for (int step = 0; step <= 20; ++step) {
        const double part = 0.05 * step;
        GloveSample sample;
        std::array<double, sensor_slots> truth{};
        for (std::size_t f = 0; f < 4; ++f) {
          truth[4 * f + 4] = part * from_degrees(80);
          truth[4 * f + 5] = part * from_degrees(95);
          truth[4 * f + 6] = 2.0 / 3.0 * truth[4 * f + 5];
        }
        for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
          const auto& line = calibration.sensors[slot];
          if (!sensors_22.has(static_cast<Sensor>(slot))) continue;
          sample.set(static_cast<Sensor>(slot),
                     RawCount{static_cast<std::uint16_t>(
                         std::lround(line.offset_counts + truth[slot] / line.gain_rad_per_count))});
        }
        const auto slot = static_cast<std::size_t>(sensor);
        sample.raw[slot].value = 255;
        const auto angles = filled_angles_rad(sample, calibration, mask({sensor}));
        CHECK(std::abs(angles[slot] - truth[slot]) < from_degrees(20.0));
        // Also two of one finger.
        const Sensor other =
            slot % 4 == 0 ? static_cast<Sensor>(slot + 1) : static_cast<Sensor>(slot - 1);
        const auto both = filled_angles_rad(sample, calibration, mask({sensor, other}));
        CHECK(std::abs(both[slot] - truth[slot]) < from_degrees(25.0));
      }
    }
  }

  TEST_CASE("couplings use the estimate: a gap does not jump with a knuckle that is left out") {
    Calibration calibration = default_calibration();
    calibration.coupling_gains[3] =
        -0.3; // of the gap between index and middle finger, by the middle MCP
    GloveSample sample;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      if (sensors_22.has(static_cast<Sensor>(slot)))
        sample.set(static_cast<Sensor>(slot), RawCount{130});
    constexpr auto gap = static_cast<std::size_t>(Sensor::index_middle_abduction);
    const auto measured = filled_angles_rad(sample, calibration, {});
    const auto filled = filled_angles_rad(sample, calibration, mask({Sensor::middle_mcp}));
    // All knuckles are bent alike, so the estimate is nearly what was measured.
    CHECK(filled[gap] == doctest::Approx(measured[gap]).epsilon(0.1));
  }

  TEST_CASE("a calibration file names what is left out, and files from before leave out nothing") {
    std::mt19937_64 random(3);
    WearerCalibration wearer = test::random_calibration(random);
    wearer.calibration[Sensor::index_pip] = {};
    wearer.calibration[Sensor::ring_mcp] = {};
    wearer.quality[static_cast<std::size_t>(Sensor::index_pip)].reset();
    wearer.quality[static_cast<std::size_t>(Sensor::ring_mcp)].reset();
    wearer.left_out = mask({Sensor::index_pip, Sensor::ring_mcp});
    const auto text = calibration_text(wearer);
    REQUIRE_MESSAGE(text, (text ? "" : text.error().message));
    CHECK(text->find("left_out = [\"index_pip\", \"ring_mcp\"]\n") != std::string::npos);
    const auto read = parse_calibration(*text, "anna.toml");
    REQUIRE_MESSAGE(read, (read ? "" : read.error().message));
    CHECK(read->left_out == wearer.left_out);
    wearer.left_out = {};
    const auto without = calibration_text(wearer);
    REQUIRE(without);
    CHECK(without->find("left_out") == std::string::npos);
    CHECK(parse_calibration(*without, "anna.toml")->left_out.bits == 0);
    for (const auto& [wrong, complaint] :
         {std::pair{"left_out = 3\n", "list"}, std::pair{"left_out = [3]\n", "quotes"},
          std::pair{"left_out = [\"pip\"]\n", "no sensor is called"}}) {
      std::string bad = *without;
      bad.insert(bad.find("version"), wrong);
      const auto refused = parse_calibration(bad, "anna.toml");
      REQUIRE_FALSE(refused);
      CHECK(refused.error().message.find(complaint) != std::string::npos);
    }
  }
}

} // namespace left_out_test
