#include <nendo/hand/range_adaptation.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "support/restraint.hpp"
#include "support/swinging_glove.hpp"

namespace range_adaptation_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;

namespace {

constexpr double tau = 6.283185307179586;
constexpr auto pip = static_cast<std::size_t>(Sensor::index_pip);
// By the default a PIP's usual 100 degrees are 0.0125 rad a count, from 60 on.
constexpr double usual_span = 1.7453292519943295 / 0.0125;

/// A visitor's glove, all of whose sensors read the same.
struct Visitor {
  CountScale counts{};
  RangeAdaptation adaptation{counts};
  HostTime now{1h};
  HostClock::duration period = test::swinging_period;

  GloveSample sample(double count) const { return test::swinging_sample(now, count); }
  void push(double count) {
    now += period;
    adaptation.push(sample(count));
  }
  /// To and fro between two counts, a swing a second.
  void swing(double low, double high, int times) {
    test::swing_between(low, high, times, [this](double count) { push(count); });
  }
  void hold(double count, double seconds) {
    for (int n = 0; n < 90.0 * seconds; ++n)
      push(count);
  }
  SensorRange range() const { return adaptation.ranges()[pip]; }
  double angle_rad(double count) const {
    const auto [gain_rad, offset] = adaptation.calibration().sensors[pip];
    return gain_rad * (count - offset);
  }
};

/// The largest change of any count's angle since `before`.
double change_rad(const Calibration& before, const Calibration& after, double most) {
  double change = 0.0;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    for (double count = 0.0; count <= most; count += most / 51.0) {
      const auto angle = [&](const Calibration& calibration) {
        const auto [gain_rad, offset] = calibration.sensors[slot];
        return gain_rad * (count - offset);
      };
      change = std::max(change, std::abs(angle(after) - angle(before)));
    }
  return change;
}

bool same_lines(const Calibration& a, const Calibration& b) {
  return change_rad(a, b, 255.0) == 0.0;
}

} // namespace

TEST_SUITE("range_adaptation") {
  TEST_CASE("it begins as the default calibration, which spans each joint's usual range") {
    for (const CountScale counts : {CountScale{255, false}, {4095, false}, {4095, true}}) {
      const RangeAdaptation adaptation(counts);
      CHECK(same_lines(adaptation.calibration(), default_calibration(counts)));
      const SensorRange range = adaptation.ranges()[pip];
      const double scale = counts.max_count / 255.0;
      CHECK(range.low_counts == doctest::Approx(counts.self_calibrated ? 0.0 : 60.0 * scale));
      CHECK(range.high_counts ==
            doctest::Approx(counts.self_calibrated ? 4095.0 : (60.0 + usual_span) * scale));
      CHECK(range.turns == 0);
    }
  }

  TEST_CASE("a hand at rest teaches nothing, however long and wherever it rests") {
    for (const double count : {1.0, 90.0, 255.0}) {
      Visitor visitor;
      std::mt19937 random(1);
      for (int n = 0; n < 90 * 300; ++n) // five minutes, with noise
        visitor.push(std::clamp(count + static_cast<double>(random() % 5) - 2.0, 0.0, 255.0));
      CHECK(same_lines(visitor.adaptation.calibration(), default_calibration()));
    }
  }

  TEST_CASE("the range that a hand moves in comes to be the joint's usual range") {
    for (const auto& [low, high] : {std::pair{40.0, 230.0}, {90.0, 190.0}, {20.0, 120.0}}) {
      Visitor visitor;
      visitor.swing(low, high, 120);
      CHECK(visitor.range().low_counts == doctest::Approx(low).epsilon(0.02));
      CHECK(visitor.range().high_counts == doctest::Approx(high).epsilon(0.02));
      CHECK(visitor.angle_rad(visitor.range().low_counts) == doctest::Approx(0.0).epsilon(0.001));
      CHECK(visitor.angle_rad(visitor.range().high_counts) ==
            doctest::Approx(100.0 / 360.0 * tau).epsilon(0.001));
      CHECK(visitor.range().turns > 200);
    }
  }

  TEST_CASE("each swing of the same size brings the bounds nearer, and never past it") {
    Visitor visitor;
    const double low = 30.0, high = 160.0; // farther down than the default, less far up
    double low_error = std::abs(60.0 - low);
    double high_error = std::abs(60.0 + usual_span - high);
    for (int n = 0; n < 60; ++n) {
      visitor.swing(low, high, 1);
      const SensorRange range = visitor.range();
      REQUIRE(range.low_counts >= low);
      REQUIRE(range.high_counts >= high);
      REQUIRE(range.low_counts - low <= low_error);
      REQUIRE(range.high_counts - high <= high_error);
      low_error = range.low_counts - low;
      high_error = range.high_counts - high;
    }
    CHECK(low_error < 1.0);
    CHECK(high_error < 4.0);
  }

  TEST_CASE("counts that are a scale times as large make the same angles") {
    for (const unsigned scale : {16U, 200U}) {
      Visitor eight;
      Visitor more{.counts = {static_cast<std::uint16_t>(255 * scale), false}};
      std::mt19937 random(2);
      double centre = 120.0;
      for (int n = 0; n < 90 * 60; ++n) {
        centre = std::clamp(centre + static_cast<double>(random() % 21) - 10.0, 20.0, 235.0);
        eight.push(std::round(centre));
        more.push(scale * std::round(centre));
        for (const double count : {0.0, 100.0, 255.0})
          REQUIRE(more.angle_rad(scale * count) ==
                  doctest::Approx(eight.angle_rad(count)).epsilon(1e-9));
      }
      CHECK(eight.range().turns > 10);
      CHECK(more.range().turns == eight.range().turns);
    }
  }

  TEST_CASE("spikes of two samples change nothing at all, and a dropped record neither") {
    Visitor clean;
    Visitor spiked;
    std::mt19937 random(3);
    for (int n = 0; n < 90 * 60; ++n) {
      const double count = 130.0 + 60.0 * std::sin(tau * n / 180.0);
      clean.push(count);
      // On the slopes: at a turn the middle one of five is another when two are missing.
      const bool spike = n % 180 > 20 && n % 180 < 22 + static_cast<int>(random() % 2);
      spiked.push(spike ? (n % 360 < 180 ? 255.0 : 1.0) : count);
    }
    CHECK(spiked.range().high_counts == doctest::Approx(clean.range().high_counts).epsilon(1e-3));
    CHECK(spiked.range().low_counts == doctest::Approx(clean.range().low_counts).epsilon(1e-3));
    CHECK(spiked.range().turns == clean.range().turns);
    for (int n = 0; n < 200; ++n) { // where they would be turns, in a hand that rests
      spiked.hold(130.0, 0.2);
      const SensorRange before = spiked.range();
      spiked.push(n % 2 == 0 ? 255.0 : 0.0);
      spiked.push(n % 2 == 0 ? 255.0 : 0.0);
      spiked.hold(130.0, 0.2);
      REQUIRE(spiked.range().high_counts == before.high_counts);
      REQUIRE(spiked.range().low_counts == before.low_counts);
    }
  }

  TEST_CASE("one excursion, however far and long, moves a bound by a small part of the range") {
    for (const double seconds : {0.1, 1.0, 60.0}) {
      Visitor visitor;
      visitor.swing(80.0, 180.0, 60);
      const SensorRange before = visitor.range();
      // Taken off and put on again: pulled to one end, left at the other.
      visitor.hold(255.0, seconds);
      visitor.hold(0.0, seconds);
      visitor.swing(80.0, 180.0, 1);
      const SensorRange after = visitor.range();
      CHECK(after.high_counts > before.high_counts);
      CHECK(after.high_counts - before.high_counts < 0.07 * usual_span);
      CHECK(before.low_counts - after.low_counts < 0.07 * usual_span);
    }
  }

  TEST_CASE("no single sample moves a bound farther than the first step's part of the range") {
    std::mt19937 random(4);
    Visitor visitor;
    for (int n = 0; n < 20'000; ++n) {
      const SensorRange before = visitor.range();
      visitor.push(static_cast<double>(random() % 256));
      const SensorRange after = visitor.range();
      REQUIRE(std::abs(after.high_counts - before.high_counts) <= 0.2501 * usual_span);
      REQUIRE(std::abs(after.low_counts - before.low_counts) <= 0.2501 * usual_span);
      REQUIRE(after.high_counts - after.low_counts >= 0.3499 * usual_span);
    }
  }

  TEST_CASE("a new visitor takes over, soon with a larger hand, slowly with a smaller one") {
    Visitor visitor;
    visitor.swing(80.0, 180.0, 120);
    visitor.swing(60.0, 220.0, 20); // 20 seconds
    CHECK(visitor.range().low_counts == doctest::Approx(60.0).epsilon(0.05));
    CHECK(visitor.range().high_counts == doctest::Approx(220.0).epsilon(0.02));
    double last = visitor.range().high_counts;
    for (int minute = 0; minute < 10; ++minute) {
      visitor.swing(80.0, 180.0, 60);
      REQUIRE(visitor.range().high_counts < last);
      last = visitor.range().high_counts;
      if (minute == 0) CHECK(last > 195.0); // a minute of small movements does not spoil it
    }
    CHECK(last < 190.0);
    CHECK(visitor.range().low_counts > 75.0);
  }

  TEST_CASE("no angle ever changes faster than the drift allowed, from the default on") {
    for (const auto period : {1ms, 11ms, 33ms, 400ms, 0ms, -5ms}) {
      Visitor visitor;
      visitor.period = period;
      std::mt19937 random(5);
      Calibration before = default_calibration();
      double moved = 0.0;
      for (int n = 0; n < 5000; ++n) {
        visitor.push(n % 1000 < 500 ? 120.0 + 100.0 * std::sin(0.2 * n)
                                    : static_cast<double>(random() % 256));
        const Calibration& after = visitor.adaptation.calibration();
        const double change = change_rad(before, after, 255.0);
        const double elapsed_s = std::clamp(to_seconds(period), 0.0, 0.1);
        REQUIRE(change <= RangeAdaptation::max_drift_rad_s * elapsed_s * 1.0001);
        moved += change;
        before = after;
      }
      CHECK((moved > 0.01) == (period > 0ms)); // it does learn
    }
  }

  TEST_CASE("each sensor learns by itself, and an absent one keeps what it knows") {
    Visitor visitor;
    visitor.swing(80.0, 180.0, 30);
    const SensorRange before = visitor.range();
    constexpr auto other = static_cast<std::size_t>(Sensor::ring_pip);
    const SensorRange other_before = visitor.adaptation.ranges()[other];
    for (int n = 0; n < 900; ++n) {
      visitor.now += visitor.period;
      GloveSample sample = visitor.sample(130.0 + 100.0 * std::sin(tau * n / 90.0));
      sample.present.bits &= ~(1U << pip);
      sample.raw[pip] = RawCount{0};
      visitor.adaptation.push(sample);
    }
    CHECK(visitor.range().low_counts == before.low_counts);
    CHECK(visitor.range().high_counts == before.high_counts);
    CHECK(visitor.adaptation.ranges()[other].high_counts > other_before.high_counts + 20.0);
    // Back again, at another place: that is no swing.
    visitor.hold(250.0, 1.0);
    visitor.hold(130.0, 1.0);
    CHECK(visitor.range().high_counts == before.high_counts);
  }

  TEST_CASE("a glove of the other hand restarts") {
    Visitor visitor;
    visitor.swing(80.0, 180.0, 60);
    REQUIRE_FALSE(same_lines(visitor.adaptation.calibration(), default_calibration()));
    GloveSample left = visitor.sample(100.0);
    left.side = Side::left;
    visitor.adaptation.push(left);
    CHECK(same_lines(visitor.adaptation.calibration(), default_calibration()));
    CHECK(visitor.range().turns == 0);
    visitor.push(100.0);
    CHECK(visitor.range().turns == 0); // not even the first one's
  }

  TEST_CASE("another one continues from what was learned, without a jump, and learns on") {
    CHECK_FALSE(RangeAdaptation().learned().has_value());
    Visitor visitor;
    visitor.swing(80.0, 180.0, 4); // the lines are still on their way
    const auto learned = visitor.adaptation.learned();
    REQUIRE(learned);
    Visitor next{.adaptation = RangeAdaptation({}, *learned), .now = visitor.now + 10s};
    next.push(180.0);
    CHECK(same_lines(next.adaptation.calibration(), visitor.adaptation.calibration()));
    const SensorRange before = next.range();
    CHECK(before.low_counts == visitor.range().low_counts);
    CHECK(before.high_counts == visitor.range().high_counts);
    CHECK(before.turns == visitor.range().turns);
    CHECK(before.turns > 4);
    visitor.swing(80.0, 180.0, 60);
    next.swing(80.0, 180.0, 60);
    CHECK(next.range().turns > before.turns + 100);
    CHECK(next.range().low_counts == doctest::Approx(visitor.range().low_counts).epsilon(0.01));
    CHECK(next.range().high_counts == doctest::Approx(visitor.range().high_counts).epsilon(0.01));

    RangeAdaptation of_other_hand({}, *learned);
    GloveSample left = visitor.sample(100.0);
    left.side = Side::left;
    of_other_hand.push(left);
    CHECK(same_lines(of_other_hand.calibration(), default_calibration()));
    CHECK(of_other_hand.ranges()[pip].turns == 0);
  }

  TEST_CASE("a sensor with values that cannot have been learned restarts, no other does") {
    Visitor visitor;
    visitor.swing(80.0, 180.0, 20);
    const auto learned = visitor.adaptation.learned();
    REQUIRE(learned);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto good = learned->sensors[pip];
    using Learned = LearnedRanges::Sensor;
    for (const Learned& bad :
         {Learned{}, Learned{nan, 200.0, 1, 1, good.line}, Learned{60.0, nan, 1, 1, good.line},
          Learned{200.0, 60.0, 1, 1, good.line}, Learned{100.0, 101.0, 1, 1, good.line},
          Learned{-5.0, 200.0, 1, 1, good.line}, Learned{60.0, 300.0, 1, 1, good.line},
          Learned{60.0, 200.0, 1, 1, {0.0, 60.0}}, Learned{60.0, 200.0, 1, 1, {-0.01, 60.0}},
          Learned{60.0, 200.0, 1, 1, {nan, 60.0}}, Learned{60.0, 200.0, 1, 1, {0.01, nan}},
          Learned{60.0, 200.0, 1, 1, {1e300, 60.0}}, Learned{60.0, 200.0, 1, 1, {0.01, -1e300}}}) {
      LearnedRanges given = *learned;
      given.sensors[pip] = bad;
      const RangeAdaptation adaptation({}, given);
      const RangeAdaptation fresh;
      CHECK(adaptation.ranges()[pip].low_counts == fresh.ranges()[pip].low_counts);
      CHECK(adaptation.ranges()[pip].turns == 0);
      CHECK(adaptation.calibration().sensors[pip].gain_rad_per_count ==
            fresh.calibration().sensors[pip].gain_rad_per_count);
      CHECK(adaptation.ranges()[pip + 1].turns == visitor.adaptation.ranges()[pip + 1].turns);
    }
  }

  TEST_CASE("whatever comes, the lines are finite and rise, and the bounds are counts") {
    std::mt19937 random(6);
    const auto any_double = [&random] {
      constexpr std::array<double, 4> likely{0.0, 1.0, 100.0, 0.01};
      if (random() % 2 == 0) return likely[random() % 4];
      return std::bit_cast<double>((std::uint64_t{random()} << 32U) | random());
    };
    for (const CountScale counts :
         {CountScale{0, false}, {0, true}, {1, false}, {1, true}, {255, false}, {65535, true}}) {
      LearnedRanges learned;
      for (auto& sensor : learned.sensors)
        sensor = {any_double(), any_double(), 1, 4'000'000'000, {any_double(), any_double()}};
      Visitor visitor{.counts = counts, .adaptation = RangeAdaptation(counts, learned)};
      for (int n = 0; n < 20'000; ++n) {
        GloveSample sample = visitor.sample(0.0);
        sample.has_device_time = random() % 2 == 0;
        const auto ticks = (std::uint64_t{random()} << 32U) | random();
        sample.measured = HostTime(HostClock::duration(static_cast<HostClock::rep>(ticks)));
        sample.arrival = sample.measured;
        sample.present = SensorMask{static_cast<std::uint32_t>(random() % 3 ? 0xFFFFFF : random())};
        for (auto& raw : sample.raw)
          raw.value = static_cast<std::uint16_t>(random());
        visitor.adaptation.push(sample);
      }
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        const auto [gain_rad, offset] = visitor.adaptation.calibration().sensors[slot];
        const SensorRange range = visitor.adaptation.ranges()[slot];
        REQUIRE(std::isfinite(gain_rad));
        REQUIRE(std::isfinite(offset));
        const bool used = default_calibration(counts).sensors[slot].gain_rad_per_count != 0.0;
        REQUIRE((gain_rad > 0.0) == used);
        REQUIRE(range.low_counts >= -1e-9);
        REQUIRE(range.high_counts <= std::max<double>(counts.max_count, 0.0) + 1e-9);
      }
    }
  }

  TEST_CASE("push allocates nothing, and takes no lock") {
    Visitor visitor;
    test::RestraintCounts counts;
    {
      const test::Restraint restraint;
      visitor.swing(40.0, 230.0, 20);
      GloveSample left = visitor.sample(100.0);
      left.side = Side::left;
      visitor.adaptation.push(left);
      counts = restraint.counts();
    }
    CHECK(counts.allocations + counts.frees + counts.locks == 0);
  }
}

} // namespace range_adaptation_test
