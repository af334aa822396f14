#include <nendo/hand/wearer.hpp>

#include <cmath>

#include <doctest/doctest.h>

namespace active_calibration_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;

namespace {

Calibration with_gain(double gain_rad) {
  Calibration calibration;
  for (auto& sensor : calibration.sensors)
    sensor = {gain_rad, 10.0};
  return calibration;
}

GloveSample sample_of(Side side, HostTime now, int count) {
  GloveSample sample;
  sample.side = side;
  sample.present = sensors_22;
  sample.arrival = sample.measured = now;
  sample.raw.fill(RawCount{static_cast<std::uint16_t>(count)});
  return sample;
}

} // namespace

TEST_SUITE("active_calibration") {
  TEST_CASE(
      "a sample gets the calibration of the hand whose glove sent it, as often as they swap") {
    for (const Side side : {Side::left, Side::right}) {
      const Side other = opposite(side);
      Wearer wearer;
      wearer.of(side).calibration = with_gain(0.01);
      wearer.of(other).calibration = with_gain(0.02);
      ActiveCalibration calibration(wearer);
      CHECK(calibration.adaptation() == nullptr);
      for (const Side now : {side, side, other, side, other, other}) {
        const auto& active = calibration.follow(sample_of(now, HostTime(1h), 100));
        CHECK(active[Sensor::index_mcp].gain_rad_per_count == (now == side ? 0.01 : 0.02));
      }
    }
  }

  TEST_CASE("an adapting one is what adaptation makes of the same samples") {
    const CountScale counts{4095, true};
    Wearer wearer;
    wearer.adapt = counts;
    ActiveCalibration calibration(wearer);
    RangeAdaptation reference(counts);
    HostTime now(1h);
    for (int n = 0; n < 2000; ++n) {
      now += 11ms;
      const Side side = n < 1500 ? Side::right : Side::left;
      const auto sample = sample_of(side, now, 2000 + static_cast<int>(900 * std::sin(0.1 * n)));
      reference.push(sample);
      const auto& active = calibration.follow(sample);
      for (std::size_t slot = 0; slot < sensor_slots; ++slot)
        REQUIRE(active.sensors[slot].offset_counts ==
                reference.calibration().sensors[slot].offset_counts);
    }
    REQUIRE(calibration.adaptation() != nullptr);
    CHECK(calibration.adaptation()->ranges()[0].turns == reference.ranges()[0].turns);
    CHECK(reference.ranges()[0].turns > 10);
  }
}

} // namespace active_calibration_test
