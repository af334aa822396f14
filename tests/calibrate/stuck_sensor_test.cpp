// Calibrations of gloves with stuck sensors, of wearers whose true joints are known: the others are
// as good as without, and an estimated joint is about as far off as its deviation says.

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/calibration_fit.hpp>

#include "calibrate/guide.hpp"
#include "reference/wearers.hpp"

namespace stuck_sensor_test {

using namespace nendo;
using namespace nendo::calibrate;
using hand::PoseId;

namespace {

struct Held {
  Sensor sensor;
  std::uint16_t count;
};

/// Guides a wearer through a free motion and all takes, in a glove with stuck sensors.
struct Guided {
  reference::Wearer wearer;
  CalibrationGuide guide;
  std::vector<Held> stuck;
  double time_s = 10.0;

  Guided(std::uint64_t seed, std::vector<Held> held)
      : wearer(seed), guide(hand::full_takes(), CountScale{}), stuck(std::move(held)) {}

  GloveSample next(const hand::SensorAngles& angles) {
    GloveSample sample = wearer.read(angles);
    for (const auto& [sensor, count] : stuck)
      sample.raw[static_cast<std::size_t>(sensor)].value = count;
    time_s += 1.0 / 90.0;
    sample.arrival = sample.measured = HostTime(from_seconds(time_s));
    return sample;
  }
  void move_freely(double seconds) {
    const reference::FreeMotion motion(3, wearer.ranges());
    for (int n = 0; n < seconds * 90.0; ++n)
      guide.push_free_motion(next(motion.angles_rad(n / 90.0)));
    guide.end_free_motion();
  }
  void take_all() {
    for (int tries = 0; !guide.is_done() && tries < 200; ++tries) {
      const hand::SensorAngles angles = wearer.perform(guide.asked());
      for (int n = 0; n < 135; ++n)
        guide.push(next(angles));
    }
  }
  Result<hand::CalibrationFit> fit() const {
    hand::FitOptions options;
    options.free_motion = guide.free_motion();
    options.hold_out = false;
    return hand::fit_calibration(guide.readings(), wearer.side(),
                                 {sensors_22.bits & ~guide.left_out().bits}, options);
  }
};

/// Root mean squares over a free motion, by angle.
struct Errors {
  std::array<double, hand::angle_count> rad{};
  std::array<double, hand::angle_count> deviation_rad{};
};

Errors errors_of(Guided& guided, const hand::Calibration& calibration, SensorMask left_out) {
  const reference::FreeMotion motion(11, guided.wearer.ranges());
  Errors errors;
  constexpr int moments = 400;
  for (int n = 0; n < moments; ++n) {
    const hand::SensorAngles truth = motion.angles_rad(0.37 * n);
    const auto angles = hand::joint_angles(guided.next(truth), calibration, left_out);
    const auto joints = reference::joints_of(truth);
    const auto deviations = hand::angle_deviations(angles, sensors_22, left_out);
    for (std::size_t at = 0; at < hand::angle_count; ++at) {
      const double off = angles[hand::angle_at(at)] - joints[hand::angle_at(at)];
      errors.rad[at] += off * off / moments;
      errors.deviation_rad[at] += deviations[at] * deviations[at] / moments;
    }
  }
  for (auto* squares : {&errors.rad, &errors.deviation_rad})
    for (double& square : *squares)
      square = std::sqrt(square);
  return errors;
}

/// Checks a glove with these stuck sensors against the same wearer's with none.
void check(std::uint64_t seed, const std::vector<Held>& stuck, const Errors& without) {
  Guided guided(seed, stuck);
  guided.move_freely(14.0);
  SensorMask expected;
  for (const Held& held : stuck)
    expected.add(held.sensor);
  CHECK(guided.guide.left_out() == expected);
  guided.take_all();
  REQUIRE(guided.guide.is_done());
  CHECK(guided.guide.left_out() == expected);
  auto fit = guided.fit();
  REQUIRE_MESSAGE(fit, (fit ? "" : fit.error().message));
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (expected.has(static_cast<Sensor>(slot)))
      fit->calibration.sensors[slot] = hand::default_calibration().sensors[slot];
  const Errors with = errors_of(guided, fit->calibration, expected);
  const auto sources = hand::angle_sources(sensors_22, expected);
  const auto usual = hand::angle_sources(sensors_22);
  for (std::size_t at = 0; at < hand::angle_count; ++at) {
    CAPTURE(hand::angle_names[at]);
    CAPTURE(to_degrees(with.rad[at]));
    CAPTURE(to_degrees(without.rad[at]));
    CAPTURE(to_degrees(with.deviation_rad[at]));
    if (sources[at] == usual[at]) {
      // Evidence is lost, and what is left agrees otherwise.
      CHECK(with.rad[at] <= 1.6 * without.rad[at] + from_degrees(6.0));
    } else {
      // All joints of a free motion go their own ways, so nothing estimates them well.
      CHECK(with.rad[at] <= from_degrees(55.0));
      CHECK(with.rad[at] <= 3.2 * with.deviation_rad[at]);
      CHECK(with.deviation_rad[at] > 1.5 * from_degrees(2.8));
    }
  }
}

} // namespace

TEST_SUITE("stuck_sensor") {
  TEST_CASE("with any one sensor stuck a wearer is calibrated, and the other joints are as good") {
    constexpr std::uint64_t seed = 2004;
    Guided whole(seed, {});
    whole.move_freely(14.0);
    whole.take_all();
    REQUIRE(whole.guide.is_done());
    CHECK(whole.guide.left_out().bits == 0);
    const auto fit = whole.fit();
    REQUIRE(fit);
    const Errors without = errors_of(whole, fit->calibration, {});
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      const auto sensor = static_cast<Sensor>(slot);
      if (!sensors_22.has(sensor)) continue;
      CAPTURE(name_of(sensor));
      check(seed, {{sensor, slot % 2 == 0 ? std::uint16_t{255} : std::uint16_t{137}}}, without);
    }
    SUBCASE("two") {
      check(seed, {{Sensor::index_pip, 255}, {Sensor::ring_mcp, 1}}, without);
      check(seed, {{Sensor::index_pip, 0}, {Sensor::index_dip, 120}}, without);
      check(seed, {{Sensor::middle_mcp, 90}, {Sensor::ring_little_abduction, 255}}, without);
      check(seed, {{Sensor::thumb_mcp, 255}, {Sensor::thumb_roll, 140}}, without);
    }
  }

  TEST_CASE("without a free motion a sensor is found as soon as poses ask for other angles") {
    for (const Held held : {Held{Sensor::index_pip, 131}, Held{Sensor::ring_mcp, 60}}) {
      Guided guided(2006, {held});
      guided.take_all();
      REQUIRE(guided.guide.is_done());
      SensorMask expected;
      expected.add(held.sensor);
      CHECK(guided.guide.left_out() == expected);
      CHECK(guided.fit());
      for (const auto& reading : guided.guide.readings())
        CHECK_FALSE(reading.held.present.has(held.sensor));
    }
  }

  TEST_CASE("a sensor at an end from the beginning does not hold up the first pose for long") {
    Guided guided(2008, {{Sensor::index_pip, 255}});
    for (int n = 0; n < 3 && guided.guide.number() == 0; ++n)
      for (const PoseId pose : {PoseId::fist, PoseId::flat}) {
        const hand::SensorAngles angles = guided.wearer.perform(pose);
        for (int k = 0; k < 135; ++k)
          guided.guide.push(guided.next(angles));
      }
    CHECK(guided.guide.left_out().has(Sensor::index_pip));
    CHECK(guided.guide.number() > 0);
  }

  TEST_CASE("a sensor that fails between two poses is left out of all of them") {
    Guided guided(2010, {});
    guided.move_freely(14.0);
    for (int n = 0; n < 6; ++n) {
      const hand::SensorAngles angles = guided.wearer.perform(guided.guide.asked());
      for (int k = 0; k < 135; ++k)
        guided.guide.push(guided.next(angles));
    }
    CHECK(guided.guide.left_out().bits == 0);
    guided.stuck = {{Sensor::middle_pip, 97}};
    guided.take_all();
    REQUIRE(guided.guide.is_done());
    CHECK(guided.guide.left_out().has(Sensor::middle_pip));
    CHECK(guided.fit());
  }

  TEST_CASE("sensors that work are never left out, whichever wearer is guided") {
    for (const std::uint64_t seed : {2011U, 2012U, 2013U, 2014U, 2015U}) {
      Guided guided(seed, {});
      if (seed % 2 == 0) guided.move_freely(14.0);
      guided.take_all();
      CHECK(guided.guide.is_done());
      CHECK(guided.guide.left_out().bits == 0);
    }
  }

  TEST_CASE("held poses of a capture show a sensor that never moved") {
    Guided guided(2016, {});
    guided.take_all();
    auto readings = guided.guide.readings();
    CHECK(still_in(readings, CountScale{}).bits == 0);
    for (auto& reading : readings)
      reading.held.mean_counts[static_cast<std::size_t>(Sensor::little_pip)] = 88.0;
    SensorMask expected;
    expected.add(Sensor::little_pip);
    CHECK(still_in(readings, CountScale{}) == expected);
  }
}

} // namespace stuck_sensor_test
