#include <nendo/hand/slip_adaptation.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "support/restraint.hpp"
#include "support/swinging_glove.hpp"

namespace slip_adaptation_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;

namespace {

constexpr auto pip = static_cast<std::size_t>(Sensor::index_pip);
constexpr auto gap = static_cast<std::size_t>(Sensor::middle_ring_abduction);
constexpr double low = 60.0, high = 200.0;

CalibratedRange ends_of_all(double low_counts, double high_counts) {
  CalibratedRange ends{Side::right, {}};
  ends.counts.present = sensors_22;
  ends.counts.low_counts.fill(low_counts);
  ends.counts.high_counts.fill(high_counts);
  return ends;
}

/// A wearer whose sensors all read the same, calibrated while they went from `low` to `high`.
struct Wearer {
  Calibration made = default_calibration();
  CalibratedRange ends = ends_of_all(low, high);
  SlipAdaptation adaptation{made, ends, CountScale{}};
  HostTime now{1h};

  GloveSample sample(double count) const { return test::swinging_sample(now, count); }
  void push(double count) {
    now += test::swinging_period;
    adaptation.push(sample(count));
  }
  /// To and fro between two counts, a swing a second.
  void swing(double from, double to, int times) {
    test::swing_between(from, to, times, [this](double count) { push(count); });
  }
  double slip(std::size_t slot = pip) const { return adaptation.slips_counts()[slot]; }
  double moved(std::size_t slot = pip) const {
    return adaptation.calibration().sensors[slot].offset_counts - made.sensors[slot].offset_counts;
  }
};

} // namespace

TEST_SUITE("slip_adaptation") {
  TEST_CASE("a glove that sits as it was calibrated keeps its calibration, to the bit") {
    Wearer wearer;
    CHECK(wearer.adaptation.calibration() == wearer.made);
    wearer.swing(low, high, 300);
    wearer.swing(90.0, 160.0, 300); // a smaller motion teaches nothing
    wearer.swing(low, 120.0, 300);  // nor who moves in a part of the range
    wearer.swing(120.0, high, 300);
    CHECK(wearer.adaptation.calibration() == wearer.made);
    CHECK(wearer.adaptation.ranges()[pip].turns > 2000);
  }

  TEST_CASE("a glove that slips is followed, up or down, and gains and couplings stay") {
    for (const double by : {-9.0, 9.0}) {
      Wearer wearer;
      wearer.swing(low + by, high + by, 1000);
      CHECK(wearer.slip() == doctest::Approx(by).epsilon(0.1));
      CHECK(wearer.moved() == doctest::Approx(wearer.slip()));
      CHECK(std::abs(wearer.slip()) <= std::abs(by));
      CHECK(wearer.adaptation.calibration().sensors[pip].gain_rad_per_count ==
            wearer.made.sensors[pip].gain_rad_per_count);
      CHECK(wearer.adaptation.calibration().coupling_gains == wearer.made.coupling_gains);
      wearer.swing(low, high, 2000); // and back
      CHECK(std::abs(wearer.slip()) < 1.0);
    }
  }

  TEST_CASE("a wearer who goes beyond both ends, or beyond one and to the other, has not slipped") {
    Wearer wearer;
    wearer.swing(low - 9.0, high + 9.0, 300);
    CHECK(wearer.slip() == 0.0);
    Wearer other;
    other.swing(low, high + 9.0, 300);
    CHECK(other.slip() == 0.0);
  }

  TEST_CASE("nothing moves faster than it may, and a tug at the glove is no slip") {
    Wearer wearer;
    wearer.swing(low + 20.0, high + 20.0, 500);
    double before = wearer.moved(), fastest = 0.0;
    test::swing_between(low - 25.0, high - 25.0, 300, [&](double count) {
      wearer.push(count);
      fastest = std::max(fastest, std::abs(wearer.moved() - before));
      before = wearer.moved();
    });
    const double most = SlipAdaptation::max_drift_rad_s / 90.0;
    CHECK(fastest * wearer.made.sensors[pip].gain_rad_per_count <= most * 1.001);
    CHECK(fastest > 0.0);

    Wearer tugged;
    tugged.swing(low, high, 20);
    tugged.swing(low + 40.0, high + 50.0, 2);
    CHECK(std::abs(tugged.slip()) < 1.5);
  }

  TEST_CASE("sensors of gaps, of unknown ends, and other hands' samples are not followed") {
    Wearer wearer;
    wearer.swing(low + 9.0, high + 9.0, 500);
    CHECK(wearer.slip(gap) == 0.0);

    Wearer unknown;
    unknown.ends.counts.present.bits &= ~(1U << pip);
    unknown.ends.counts.low_counts[pip + 1] = std::numeric_limits<double>::quiet_NaN();
    unknown.ends.counts.high_counts[pip + 4] = low + 3.0; // it hardly moved
    unknown.adaptation = SlipAdaptation(unknown.made, unknown.ends, CountScale{});
    unknown.swing(low + 9.0, high + 9.0, 500);
    for (const std::size_t slot : {pip, pip + 1, pip + 4}) {
      CHECK(unknown.slip(slot) == 0.0);
      CHECK(unknown.adaptation.calibration().sensors[slot] == unknown.made.sensors[slot]);
    }
    CHECK(unknown.slip(pip + 5) > 5.0);

    Wearer other;
    for (int n = 0; n < 90 * 500; ++n) {
      other.now += 11ms;
      GloveSample sample = other.sample(low + 9.0 + (high - low) * (n / 45 % 2));
      sample.side = Side::left;
      other.adaptation.push(sample);
    }
    CHECK(other.adaptation.calibration() == other.made);
  }

  TEST_CASE("another learner continues from what was learned") {
    Wearer wearer;
    wearer.swing(low + 9.0, high + 9.0, 500);
    Wearer next;
    next.adaptation =
        SlipAdaptation(next.made, next.ends, CountScale{}, wearer.adaptation.learned());
    CHECK(next.adaptation.calibration() == wearer.adaptation.calibration());
    CHECK(next.slip() == wearer.slip());
    CHECK(next.adaptation.ranges()[pip].turns == wearer.adaptation.ranges()[pip].turns);
    LearnedRanges wrong = wearer.adaptation.learned();
    wrong.sensors[pip].line.offset_counts = std::numeric_limits<double>::quiet_NaN();
    wrong.sensors[pip + 1].low_counts = 300.0;
    next.adaptation = SlipAdaptation(next.made, next.ends, CountScale{}, wrong);
    CHECK(next.slip(pip) == 0.0);
    CHECK(next.slip(pip + 1) == 0.0);
    CHECK(next.slip(pip + 4) == wearer.slip(pip + 4));
    wrong.side = Side::left; // learned from the other hand
    next.adaptation = SlipAdaptation(next.made, next.ends, CountScale{}, wrong);
    CHECK(next.adaptation.calibration() == next.made);
  }

  TEST_CASE("whatever comes, the lines are finite, and no slip is greater than it may be") {
    std::mt19937 random(6);
    const auto any_double = [&random] {
      constexpr std::array<double, 4> likely{0.0, 1.0, 100.0, 200.0};
      if (random() % 2 == 0) return likely[random() % 4];
      return std::bit_cast<double>((std::uint64_t{random()} << 32U) | random());
    };
    for (const CountScale counts :
         {CountScale{0, false}, {0, true}, {1, false}, {255, false}, {65535, true}}) {
      Wearer wearer;
      wearer.made = default_calibration(counts);
      LearnedRanges learned;
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        wearer.ends.counts.low_counts[slot] = any_double();
        wearer.ends.counts.high_counts[slot] = any_double();
        learned.sensors[slot] = {
            any_double(), any_double(), 1, 4'000'000'000, {any_double(), any_double()}};
      }
      wearer.adaptation = SlipAdaptation(wearer.made, wearer.ends, counts, learned);
      for (int n = 0; n < 20'000; ++n) {
        GloveSample sample = wearer.sample(0.0);
        const auto ticks = (std::uint64_t{random()} << 32U) | random();
        sample.measured = HostTime(HostClock::duration(static_cast<HostClock::rep>(ticks)));
        sample.present = SensorMask{static_cast<std::uint32_t>(random() % 3 ? 0xFFFFFF : random())};
        for (auto& raw : sample.raw)
          raw.value = static_cast<std::uint16_t>(random());
        wearer.adaptation.push(sample);
      }
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        REQUIRE(std::isfinite(wearer.adaptation.calibration().sensors[slot].offset_counts));
        const double span =
            wearer.ends.counts.high_counts[slot] - wearer.ends.counts.low_counts[slot];
        const double most = SlipAdaptation::max_slip * span;
        if (wearer.slip(slot) != 0.0) REQUIRE(std::abs(wearer.slip(slot)) <= most);
      }
    }
  }

  TEST_CASE("push allocates nothing, and takes no lock") {
    Wearer wearer;
    test::RestraintCounts counts;
    {
      const test::Restraint restraint;
      wearer.swing(low + 9.0, high + 9.0, 20);
      counts = restraint.counts();
    }
    CHECK(counts.allocations + counts.frees + counts.locks == 0);
  }
}

} // namespace slip_adaptation_test
