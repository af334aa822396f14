#include <nendo/hand/joint_limits.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include <nendo/hand/joint_angles.hpp>

namespace joint_limits_test {

using namespace nendo;
using namespace nendo::hand;

namespace {

constexpr double rad = 3.14159265358979323846 / 180.0;

template <class Law>
void for_each_limit(const Law& law) {
  for (std::size_t n = 0; n < angle_count; ++n) {
    CAPTURE(angle_names[n]);
    law(joint_limits[n]);
  }
}

/// From 60 degrees below the range to 60 above it, in steps of about 0.06 degrees.
template <class Law>
void sweep(const JointLimit& limit, const Law& law) {
  const double beyond = 60 * rad;
  for (double angle = limit.min_rad - beyond; angle <= limit.max_rad + beyond; angle += 1e-3)
    law(angle);
}

} // namespace

TEST_SUITE("joint_limits") {
  TEST_CASE("each joint's ends are in order about zero, and its soft stops have a width") {
    for_each_limit([](const JointLimit& limit) {
      CHECK(limit.min_rad < limit.soft_min_rad);
      CHECK(limit.soft_min_rad < 0.0);
      CHECK(limit.soft_max_rad > 0.0);
      CHECK(limit.soft_max_rad < limit.max_rad);
    });
  }

  TEST_CASE("an angle before the soft stops is untouched, to the last bit") {
    std::mt19937 random(3);
    for_each_limit([&](const JointLimit& limit) {
      std::uniform_real_distribution<double> inside(limit.soft_min_rad, limit.soft_max_rad);
      for (int n = 0; n < 1000; ++n) {
        const double angle = inside(random);
        REQUIRE(limit.soften(angle) == angle);
      }
      CHECK(limit.soften(limit.soft_min_rad) == limit.soft_min_rad);
      CHECK(limit.soften(limit.soft_max_rad) == limit.soft_max_rad);
    });
  }

  TEST_CASE("a flat hand, a fist, spread fingers and a turned wrist meet no soft stop") {
    const auto untouched = [](Angle angle, double degrees) {
      CAPTURE(name_of(angle));
      CHECK(limit_of(angle).soften(degrees * rad) == degrees * rad);
    };
    for (std::size_t n = 0; n < angle_count; ++n)
      untouched(angle_at(n), 0);
    for (const std::string finger : {"index", "middle", "ring", "little"}) {
      for (std::size_t n = 0; n < angle_count; ++n) {
        if (angle_names[n] == finger + "_mcp_flexion") untouched(angle_at(n), 90);
        if (angle_names[n] == finger + "_pip_flexion") untouched(angle_at(n), 100);
        if (angle_names[n] == finger + "_dip_flexion") untouched(angle_at(n), 79.9);
      }
    }
    untouched(Angle::thumb_mcp_flexion, 55);
    untouched(Angle::thumb_ip_flexion, 79.9);
    untouched(Angle::thumb_roll, 75);
    untouched(Angle::thumb_abduction, 50);
    untouched(Angle::index_mcp_abduction, 25);
    untouched(Angle::ring_mcp_abduction, -25);
    untouched(Angle::little_mcp_abduction, -50);
    untouched(Angle::palm_arch, 25);
    untouched(Angle::wrist_pitch, -69.9);
    untouched(Angle::wrist_pitch, 79.9);
  }

  TEST_CASE("every angle stays within the limits, on its own side, and never grows by softening") {
    for_each_limit([](const JointLimit& limit) {
      sweep(limit, [&](double angle) {
        const double soft = limit.soften(angle);
        REQUIRE(soft >= limit.min_rad);
        REQUIRE(soft <= limit.max_rad);
        REQUIRE(std::abs(soft) <= std::abs(angle));
        REQUIRE(soft * angle >= 0.0);
      });
    });
  }

  TEST_CASE("softening is strictly monotone where a glove can read, also past the limit") {
    for_each_limit([](const JointLimit& limit) {
      double before = -10.0;
      sweep(limit, [&](double angle) {
        const double soft = limit.soften(angle);
        REQUIRE(soft > before);
        before = soft;
      });
      // A degree too much at the end is still a fifth of one that is seen.
      const double step = limit.soften(limit.max_rad + rad) - limit.soften(limit.max_rad);
      CHECK(step > 0.15 * rad);
    });
  }

  TEST_CASE("neighbouring doubles are never put in the wrong order") {
    for_each_limit([](const JointLimit& limit) {
      for (const double about : {limit.soft_min_rad, limit.soft_max_rad, limit.min_rad,
                                 limit.max_rad, 10 * limit.max_rad, -1e15, 1e15}) {
        double angle = about;
        for (int n = 0; n < 200; ++n)
          angle = std::nextafter(angle, -1e300);
        for (int n = 0; n < 400; ++n) {
          const double next = std::nextafter(angle, 1e300);
          REQUIRE(limit.soften(next) >= limit.soften(angle));
          angle = next;
        }
      }
    });
  }

  TEST_CASE("the slope has no corner") {
    // Central differences. Where a stop of width w begins, the slope bends by 2 / w a radian at the
    // most, so over the 2h between two differences by 4h / w. A clamp's corner would be 1.
    for_each_limit([](const JointLimit& limit) {
      constexpr double h = 1e-5;
      const double narrowest =
          std::min(limit.soft_min_rad - limit.min_rad, limit.max_rad - limit.soft_max_rad);
      const auto slope = [&](double angle) {
        return (limit.soften(angle + h) - limit.soften(angle - h)) / (2 * h);
      };
      for (const double about :
           {limit.soft_min_rad, limit.soft_max_rad, limit.min_rad, limit.max_rad}) {
        for (double angle = about - 0.02; angle < about + 0.02; angle += h)
          REQUIRE(std::abs(slope(angle + h) - slope(angle - h)) < 4.5 * h / narrowest + 1e-8);
      }
      CHECK(slope(limit.soft_max_rad + 2 * h) == doctest::Approx(1.0).epsilon(0.01));
      CHECK(slope(limit.soft_min_rad - 2 * h) == doctest::Approx(1.0).epsilon(0.01));
    });
  }

  TEST_CASE("every double becomes a possible angle, and NaN the lower end") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::mt19937_64 random(9);
    for_each_limit([&](const JointLimit& limit) {
      CHECK(limit.soften(std::numeric_limits<double>::quiet_NaN()) == limit.min_rad);
      CHECK(limit.soften(infinity) == doctest::Approx(limit.max_rad));
      CHECK(limit.soften(-infinity) == doctest::Approx(limit.min_rad));
      for (int n = 0; n < 20000; ++n) {
        const std::uint64_t bits = random(); // any double, NaNs and infinities among them
        double angle = 0.0;
        static_assert(sizeof angle == sizeof bits);
        std::memcpy(&angle, &bits, sizeof angle);
        const double soft = limit.soften(angle);
        REQUIRE(soft >= limit.min_rad);
        REQUIRE(soft <= limit.max_rad);
      }
    });
  }

  TEST_CASE("a joint's name, its place in the pose and its limit belong together") {
    JointAngles angles;
    for (std::size_t n = 0; n < angle_count; ++n)
      angles[angle_at(n)] = static_cast<double>(n + 1);
    CHECK(angles.thumb_roll_rad == 1.0);
    CHECK(angles.thumb_ip_flexion_rad == 4.0);
    CHECK(angles[Angle::index_pip_flexion] == angles[Finger::index].pip_flexion_rad);
    CHECK(angles[Angle::middle_dip_flexion] == angles[Finger::middle].dip_flexion_rad);
    CHECK(angles[Angle::ring_mcp_abduction] == angles[Finger::ring].mcp_abduction_rad);
    CHECK(angles[Angle::little_mcp_flexion] == angles[Finger::little].mcp_flexion_rad);
    CHECK(angles[Angle::palm_arch] == angles.palm_arch_rad);
    CHECK(angles[Angle::wrist_yaw] == angles.wrist_yaw_rad);
    double sum = 0.0; // none stands for two: 1 + 2 + ... + 23
    for (std::size_t n = 0; n < angle_count; ++n)
      sum += angles[angle_at(n)];
    CHECK(sum == 276.0);
    CHECK(name_of(Angle::ring_mcp_abduction) == "ring_mcp_abduction");
    CHECK(name_of(Angle::wrist_yaw) == "wrist_yaw");
  }
}

} // namespace joint_limits_test
