#include <nendo/base/units.hpp>

#include <cmath>
#include <limits>

#include <doctest/doctest.h>

namespace units_test {

using namespace nendo;
using namespace std::chrono_literals;

TEST_SUITE("units") {
  TEST_CASE("a right angle is 90 degrees, and there and back is where it was") {
    CHECK(from_degrees(90.0) == doctest::Approx(std::acos(0.0)).epsilon(1e-15));
    CHECK(to_degrees(std::acos(-1.0)) == doctest::Approx(180.0).epsilon(1e-15));
    CHECK(from_degrees(0.0) == 0.0);
    for (double angle_deg = -720.0; angle_deg < 720.0; angle_deg += 7.3) {
      CHECK(to_degrees(from_degrees(angle_deg)) == doctest::Approx(angle_deg).epsilon(1e-14));
      CHECK(std::sin(from_degrees(angle_deg)) ==
            doctest::Approx(std::sin(from_degrees(angle_deg + 360.0))).epsilon(1e-9));
    }
  }

  TEST_CASE("seconds between two times have a sign, and any two times have some") {
    const HostTime time(1h);
    CHECK(seconds_between(time, time + 250ms) == 0.25);
    CHECK(seconds_between(time + 250ms, time) == -0.25);
    using Limits = std::numeric_limits<HostClock::rep>;
    const HostTime first{HostClock::duration(Limits::min())};
    const HostTime last{HostClock::duration(Limits::max())};
    CHECK(std::isfinite(seconds_between(first, last)));
    CHECK(std::isfinite(seconds_between(last, first)));
  }
}

} // namespace units_test
