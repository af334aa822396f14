#include <nendo/flow/pacer.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace spin_margin_test {

using namespace nendo;
using namespace nendo::flow;
using namespace std::chrono_literals;

namespace {

/// The margin after a second at 1 kHz in which all wake-ups were `usual` late but for some.
HostClock::duration margin_after(HostClock::duration usual, int exceptions,
                                 HostClock::duration exceptional) {
  SpinMargin margin(1ms);
  for (int n = 0; n < 1000; ++n)
    margin.observe(n < exceptions ? exceptional : usual);
  return margin.get();
}

} // namespace

TEST_SUITE("spin_margin") {
  TEST_CASE("it begins with what costs a 25th of the time, and is never above its most") {
    CHECK(SpinMargin(1ms).get() == 40us);
    CHECK(SpinMargin(500us).get() == 20us);
    CHECK(SpinMargin(11ms).get() == 100us);
    SpinMargin margin(250us);
    for (int n = 0; n < 4000; ++n)
      margin.observe(1ms);
    CHECK(margin.get() == 50us); // a fifth of the period
  }

  TEST_CASE("it covers what 99.9 % of a second's wake-ups needed, and 5 microseconds") {
    for (const auto usual : {0us, 1us, 14us, 60us}) {
      const auto margin = margin_after(usual, 0, 0us);
      CHECK(margin >= usual + 5us);
      CHECK(margin <= usual + 6us); // whole microseconds are counted
    }
    CHECK(margin_after(60us, 1, 90us) == margin_after(60us, 0, 0us));
    CHECK(margin_after(60us, 2, 90us) >= 95us);
  }

  TEST_CASE("a machine that is always late does not have it spin for longer than the most") {
    CHECK(margin_after(10ms, 0, 0us) == 100us);
    CHECK(margin_after(97us, 0, 0us) == 100us);
  }

  TEST_CASE("what it spins is a 25th of the time at the most, whatever the wake-ups are like") {
    std::mt19937 random(7);
    for (const auto period : {1000us, 500us, 250us}) {
      for (const double mean_us : {2.0, 15.0, 40.0}) {
        std::exponential_distribution<double> lateness_us(1.0 / mean_us);
        SpinMargin margin(period);
        std::vector<HostClock::duration> second;
        for (auto n = 1s / period; n > 0; --n)
          second.push_back(std::chrono::nanoseconds(std::llround(1e3 * lateness_us(random))));
        for (const auto lateness : second)
          margin.observe(lateness);
        HostClock::duration spun{};
        for (const auto lateness : second)
          spun += std::max(margin.get() - lateness, HostClock::duration::zero());
        CHECK(to_seconds(spun) <= 1.0 / 25.0);
        // And not much less, where more was needed.
        if (margin.get() < std::min(100us, period / 5) && mean_us > 2.0)
          CHECK(to_seconds(spun) > 0.9 / 25.0);
      }
    }
  }

  TEST_CASE("each second is judged by itself, so that a bad one is forgotten after the next") {
    SpinMargin margin(1ms);
    for (int n = 0; n < 1000; ++n)
      margin.observe(70us);
    const auto bad = margin.get();
    for (int n = 0; n < 999; ++n) {
      margin.observe(10us);
      REQUIRE(margin.get() == bad);
    }
    margin.observe(10us);
    CHECK(margin.get() <= 16us);
  }

  TEST_CASE("a clock that steps back counts as no lateness") {
    CHECK(margin_after(-5us, 0, 0us) == margin_after(0us, 0, 0us));
  }
}

} // namespace spin_margin_test
