#include <nendo/hand/joint_filter.hpp>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace joint_filter_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;

namespace {

constexpr double tau = 6.283185307179586;
constexpr Angle pip = Angle::index_pip_flexion;

FilterOptions one_euro(double min_cutoff_hz, double beta_hz_per_rad_s) {
  return {FilterKind::one_euro, min_cutoff_hz, beta_hz_per_rad_s, 1.0};
}
constexpr FilterOptions by_default{FilterKind::one_euro};

JointAngles all_at(double angle_rad) {
  JointAngles angles;
  for (std::size_t n = 0; n < angle_count; ++n)
    angles[angle_at(n)] = angle_rad;
  return angles;
}

/// A filter and a clock.
struct Filtered {
  JointFilter filter;
  HostTime now{1h};

  double pass(double angle_rad, double interval_s) {
    now += std::chrono::round<HostClock::duration>(std::chrono::duration<double>(interval_s));
    return filter.pass(all_at(angle_rad), now)[pip];
  }
};

/// Intervals between samples, seconds, again and again: a glove's own clock at several rates, a
/// clockless one's bursts, and one whose line stalls.
const std::vector<std::vector<double>> rhythms{
    {1.0 / 30}, {1.0 / 90}, {0.001}, {0.0, 2.0 / 90}, {0.011, 0.011, 0.3, 0.0, 0.002, 0.04}};

} // namespace

TEST_SUITE("joint_filter") {
  TEST_CASE("switched off it passes every number as it is, at any time") {
    JointFilter filter;
    CHECK(filter.options().kind == FilterKind::off);
    std::mt19937 random(1);
    for (int n = 0; n < 1000; ++n) {
      JointAngles angles;
      for (std::size_t k = 0; k < angle_count; ++k)
        angles[angle_at(k)] = std::ldexp(static_cast<double>(random()), int(random() % 60) - 60);
      const JointAngles passed = filter.pass(angles, HostTime(HostClock::duration(random())));
      for (std::size_t k = 0; k < angle_count; ++k)
        REQUIRE(passed[angle_at(k)] == angles[angle_at(k)]);
    }
    CHECK(filter.latency().worst_s == 0.0);
    CHECK(filter.latency_s(pip) == 0.0);
  }

  TEST_CASE("a constant passes unchanged, in any rhythm") {
    for (const auto& rhythm : rhythms) {
      Filtered filtered{JointFilter(by_default)};
      for (std::size_t n = 0; n < 500; ++n)
        REQUIRE(filtered.pass(0.7, rhythm[n % rhythm.size()]) == 0.7);
    }
  }

  TEST_CASE("it is the paper's algorithm at a constant rate") {
    // Casiez et al., algorithm 1, written as they do: by rate and smoothing factor.
    constexpr double rate_hz = 125.0; // a period without remainder in nanoseconds
    const FilterOptions options{FilterKind::one_euro, 1.5, 0.8, 1.2};
    const auto alpha = [](double cutoff_hz) { return 1.0 / (1.0 + rate_hz / (tau * cutoff_hz)); };
    Filtered filtered{JointFilter(options)};
    std::mt19937 random(2);
    std::normal_distribution<double> noise(0.0, 0.1);
    double last = 0.0;
    double derivative = 0.0;
    double smooth = 0.0;
    for (int n = 0; n < 2000; ++n) {
      const double x = std::sin(0.03 * n) + noise(random);
      const double passed = filtered.pass(x, 1.0 / rate_hz);
      if (n == 0) {
        smooth = x;
      } else {
        const double a_d = alpha(options.derivative_cutoff_hz);
        derivative = a_d * (x - last) * rate_hz + (1.0 - a_d) * derivative;
        const double a =
            alpha(options.min_cutoff_hz + options.beta_hz_per_rad_s * std::abs(derivative));
        smooth = a * x + (1.0 - a) * smooth;
      }
      last = x;
      REQUIRE(passed == doctest::Approx(smooth).epsilon(1e-9));
    }
  }

  TEST_CASE("a steady movement comes out late by the latency that is reported, in any rhythm") {
    for (const auto& rhythm : rhythms) {
      for (const double beta : {0.0, 2.0}) {
        for (const double speed_rad_s : {-4.0, 0.2, 1.0, 4.0}) {
          Filtered filtered{JointFilter(one_euro(2.0, beta))};
          const double start_rad = speed_rad_s > 0.0 ? -6.0 : 6.0;
          double time_s = 0.0;
          double late_s = 0.0;
          for (std::size_t n = 0; time_s < 2.8; ++n) {
            const double interval_s = rhythm[n % rhythm.size()];
            time_s += interval_s;
            const double angle = start_rad + speed_rad_s * time_s;
            late_s = (angle - filtered.pass(angle, interval_s)) / speed_rad_s;
          }
          CAPTURE(speed_rad_s);
          CHECK(filtered.filter.latency_s(pip) == doctest::Approx(late_s).epsilon(0.03));
          const double cutoff_hz = 2.0 + beta * std::abs(speed_rad_s);
          CHECK(late_s == doctest::Approx(1.0 / (tau * cutoff_hz)).epsilon(0.03));
        }
      }
    }
  }

  TEST_CASE("noise comes out smaller, by as much as a first-order lag makes it") {
    constexpr double rate_hz = 100.0;
    constexpr double noise_rad = 0.0125; // a count of a CyberGlove
    for (const double beta : {0.0, 2.0}) {
      Filtered filtered{JointFilter(one_euro(2.0, beta))};
      std::mt19937 random(3);
      std::normal_distribution<double> noise(0.0, noise_rad);
      double squares = 0.0;
      constexpr int count = 50'000;
      for (int n = 0; n < count; ++n) {
        const double passed = filtered.pass(0.8 + noise(random), 1.0 / rate_hz);
        squares += (passed - 0.8) * (passed - 0.8);
      }
      const double left = squares / count / (noise_rad * noise_rad);
      // The variance of a first-order recursion on white noise.
      const double alpha = 1.0 / (1.0 + rate_hz / (tau * 2.0));
      if (beta == 0.0) CHECK(left == doctest::Approx(alpha / (2.0 - alpha)).epsilon(0.05));
      CHECK(left < 0.1);
    }
  }

  TEST_CASE("a step is followed without a turn back or an overshoot, and is reached") {
    for (const auto& rhythm : rhythms) {
      for (const FilterOptions& options : {by_default, one_euro(0.5, 50.0), one_euro(1e9, 1e9)}) {
        Filtered filtered{JointFilter(options)};
        filtered.pass(0.2, 0.01);
        double before = 0.2;
        for (std::size_t n = 0; n < 6000; ++n) {
          const double passed = filtered.pass(1.3, rhythm[n % rhythm.size()]);
          REQUIRE(passed >= before);
          REQUIRE(passed <= 1.3);
          before = passed;
        }
        CHECK(before == doctest::Approx(1.3).epsilon(1e-4));
      }
    }
  }

  TEST_CASE("whatever comes in, what goes out is never outside of it") {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> angle(-1.0, 1.0);
    Filtered filtered{JointFilter(one_euro(3.0, 20.0))};
    double low = 1.0;
    double high = -1.0;
    for (int n = 0; n < 5000; ++n) {
      const double x = angle(random) * n / 5000.0;
      low = std::min(low, x);
      high = std::max(high, x);
      const double passed = filtered.pass(x, 0.001 * static_cast<double>(random() % 40));
      REQUIRE(passed >= low);
      REQUIRE(passed <= high);
    }
  }

  TEST_CASE("after a pause, or with a clock that went far back, it restarts") {
    for (const double pause_s : {0.501, 3.0, 1e6, -0.501, -100.0}) {
      Filtered filtered{JointFilter(by_default)};
      for (int n = 0; n < 30; ++n)
        filtered.pass(0.05 * n, 0.011);
      const double resting_s = 1.0 / (tau * by_default.min_cutoff_hz);
      CHECK(filtered.filter.latency_s(pip) < 0.5 * resting_s);
      CHECK(filtered.pass(-0.3, pause_s) == -0.3);
      CHECK(filtered.filter.latency_s(pip) == doctest::Approx(resting_s));
      CHECK(filtered.pass(-0.3, 0.011) == -0.3);
    }
    Filtered filtered{JointFilter(by_default)};
    filtered.pass(0.0, 0.0);
    CHECK(filtered.pass(1.0, 0.499) < 1.0); // that was no pause
  }

  TEST_CASE("a time that stops or goes back a little moves nothing, and time continues") {
    for (const double interval_s : {0.0, -0.004, -0.3}) {
      Filtered filtered{JointFilter(by_default)};
      filtered.pass(0.0, 0.0);
      const double before = filtered.pass(0.4, 0.01);
      CHECK(filtered.pass(0.5, interval_s) == before);
      CHECK(filtered.pass(0.5, 0.01) > before);
    }
  }

  TEST_CASE("each joint is filtered by itself") {
    JointFilter alone(by_default);
    JointFilter together(by_default);
    for (int n = 0; n < 200; ++n) {
      const HostTime now(1h + n * 11ms);
      JointAngles one;
      one[pip] = std::sin(0.1 * n);
      JointAngles all = all_at(std::cos(0.3 * n));
      all[pip] = one[pip];
      const JointAngles passed = alone.pass(one, now);
      REQUIRE(together.pass(all, now)[pip] == passed[pip]);
      for (std::size_t k = 0; k < angle_count; ++k) {
        if (angle_at(k) != pip) REQUIRE(passed[angle_at(k)] == 0.0);
      }
    }
  }

  TEST_CASE("the summary of the latencies is their greatest and their mean") {
    JointFilter filter(by_default);
    CHECK(filter.latency().worst_s == 0.0); // nothing has been late yet
    for (int n = 0; n < 100; ++n) {
      JointAngles angles;
      for (std::size_t k = 0; k < angle_count; ++k)
        angles[angle_at(k)] = 0.001 * static_cast<double>(k) * n;
      filter.pass(angles, HostTime(1h + n * 11ms));
    }
    double worst_s = 0.0;
    double sum_s = 0.0;
    for (std::size_t k = 0; k < angle_count; ++k) {
      worst_s = std::max(worst_s, filter.latency_s(angle_at(k)));
      sum_s += filter.latency_s(angle_at(k));
      if (k > 0) CHECK(filter.latency_s(angle_at(k)) < filter.latency_s(angle_at(k - 1)));
    }
    CHECK(filter.latency().worst_s == worst_s);
    CHECK(filter.latency().mean_s == doctest::Approx(sum_s / 23.0));
    CHECK(worst_s == doctest::Approx(1.0 / (tau * by_default.min_cutoff_hz))); // the one at rest
  }

  TEST_CASE("the latency of moving joints counts each joint by its speed") {
    JointFilter filter(by_default);
    CHECK(filter.latency().moving_s == 0.0);
    filter.pass({}, HostTime(1h));
    CHECK(filter.latency().moving_s == doctest::Approx(filter.latency().mean_s)); // none moves
    JointAngles angles;
    for (int n = 1; n < 200; ++n) { // one joint moves
      angles[pip] = 0.01 * n;
      filter.pass(angles, HostTime(1h + n * 11ms));
    }
    CHECK(filter.latency().moving_s == doctest::Approx(filter.latency_s(pip)));
    CHECK(filter.latency().moving_s < 0.5 * filter.latency().mean_s);
    // Two that move: as far behind as both together, divided by their speeds.
    double behind_rad = 0.0;
    for (int n = 200; n < 500; ++n) {
      angles[pip] = 0.01 * n;
      angles[Angle::wrist_yaw] = -0.003 * (n - 199);
      const JointAngles passed = filter.pass(angles, HostTime(1h + n * 11ms));
      behind_rad = angles[pip] - passed[pip] + passed[Angle::wrist_yaw] - angles[Angle::wrist_yaw];
    }
    CHECK(filter.latency().moving_s == doctest::Approx(behind_rad / (0.013 / 0.011)).epsilon(0.01));
  }

  TEST_CASE("an angle that is none is passed over") {
    for (const double strange : {std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity(), -1e300, 7.0}) {
      Filtered filtered{JointFilter(by_default)};
      CHECK(filtered.pass(strange, 0.01) == 0.0);
      filtered.pass(0.5, 0.6);
      CHECK(filtered.pass(strange, 0.01) == 0.5);
      CHECK(filtered.pass(strange, 2.0) == 0.5);
      CHECK(filtered.pass(0.5, 0.01) == 0.5);
    }
  }

  TEST_CASE("no options, angles or times make anything that is not finite") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> strange{0.0,    -1.0,     1e-300,    1e300,
                                      -1e300, infinity, -infinity, std::nan("")};
    std::mt19937_64 random(8);
    const auto any = [&] { return strange[random() % strange.size()]; };
    for (int round = 0; round < 300; ++round) {
      JointFilter filter({FilterKind::one_euro, any(), any(), any()});
      for (int n = 0; n < 60; ++n) {
        const bool sane = random() % 2 == 0;
        const JointAngles angles =
            all_at(sane ? static_cast<double>(random() % 100) / 50.0 : any());
        // From one end of the clock to the other, or a few milliseconds on.
        const auto ticks = random() % 2 == 0
                               ? static_cast<HostClock::rep>(random())
                               : static_cast<HostClock::rep>(random() % 1'000'000'000);
        const JointAngles passed = filter.pass(angles, HostTime(HostClock::duration(ticks)));
        for (std::size_t k = 0; k < angle_count; ++k)
          REQUIRE(std::abs(passed[angle_at(k)]) <= tau);
        REQUIRE(std::isfinite(filter.latency().worst_s));
        REQUIRE(filter.latency().moving_s <= filter.latency().worst_s * 1.000001);
        REQUIRE(filter.latency().mean_s <= filter.latency().worst_s * 1.000001);
      }
    }
  }

  TEST_CASE("filters have names") {
    CHECK(filter_named("off") == FilterKind::off);
    CHECK(filter_named("one-euro") == FilterKind::one_euro);
    CHECK(filter_named(name_of(FilterKind::one_euro)) == FilterKind::one_euro);
    CHECK_FALSE(filter_named("One-Euro"));
    CHECK_FALSE(filter_named(""));
  }
}

} // namespace joint_filter_test
