#include <nendo/deform/wendland.hpp>

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

namespace wendland_test {

using nendo::deform::Wendland;
using nendo::deform::wendland;

TEST_SUITE("wendland") {
  constexpr Wendland kernels[] = {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6};

  TEST_CASE("every function is 1 at the centre, falls, and is 0 from the radius on") {
    for (const Wendland kernel : kernels) {
      CHECK(wendland(kernel, 0.0) == 1.0);
      for (int i = 0; i < 99; ++i)
        CHECK(wendland(kernel, (i + 1) / 100.0) < wendland(kernel, i / 100.0));
      CHECK(wendland(kernel, 1.0) == 0.0);
      CHECK(wendland(kernel, 1e300) == 0.0);
      CHECK(wendland(kernel, std::nan("")) == 0.0);
    }
  }

  // Fasshauer, Meshfree Approximation Methods (2007), table 11.1, by hand at t = 1/2.
  TEST_CASE("the functions have their published values at half the radius") {
    CHECK(wendland(Wendland::c0, 0.5) == doctest::Approx(1.0 / 4));
    CHECK(wendland(Wendland::c2, 0.5) == doctest::Approx(3.0 / 16));
    CHECK(wendland(Wendland::c4, 0.5) == doctest::Approx((35.0 / 4 + 9 + 3) / 3 / 64));
    CHECK(wendland(Wendland::c6, 0.5) == doctest::Approx((4.0 + 25.0 / 4 + 4 + 1) / 256));
  }

  TEST_CASE("the steepest slopes are those that bound a displacement without folds") {
    const double steepest[] = {2.0, 2.109, 2.500, 2.819};
    for (int k = 0; k < 4; ++k) {
      double slope = 0.0;
      for (int i = 0; i < 10'000; ++i) {
        const double t = i * 1e-4;
        slope = std::max(slope, (wendland(kernels[k], t) - wendland(kernels[k], t + 1e-4)) / 1e-4);
      }
      CHECK(slope == doctest::Approx(steepest[k]).epsilon(1e-3));
    }
  }

  TEST_CASE("the slope is what differences tend to, steepest where it is said to be") {
    using nendo::deform::wendland_slope;
    using nendo::deform::wendland_steepest_at;
    for (const Wendland kernel : kernels) {
      const double peak = wendland_steepest_at(kernel);
      for (int i = 1; i < 1200; ++i) {
        const double t = i * 1e-3;
        const double slope = wendland_slope(kernel, t);
        CHECK(slope ==
              doctest::Approx((wendland(kernel, t + 1e-6) - wendland(kernel, t - 1e-6)) / 2e-6)
                  .epsilon(1e-5));
        CHECK(std::abs(slope) <= std::abs(wendland_slope(kernel, peak)));
        const double next = wendland_slope(kernel, t + 1e-3);
        CHECK((t < peak - 1e-3 ? next <= slope : t < peak || next >= slope));
      }
    }
  }

  TEST_CASE("a name leads back to its function, and no other does") {
    using nendo::deform::name_of;
    using nendo::deform::wendland_named;
    for (const Wendland kernel : kernels)
      CHECK(wendland_named(name_of(kernel)) == kernel);
    CHECK_FALSE(wendland_named("wendland-c1"));
    CHECK_FALSE(wendland_named(""));
  }
}

} // namespace wendland_test
