#include <nendo/hand/pose_filter.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace pose_filter_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;
using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double tau = 6.283185307179586;
constexpr PoseFilterOptions by_default{FilterKind::one_euro};
/// Of four stations of a FASTRAK, of two, of one, and of a LIBERTY.
constexpr std::array rates_hz{30.0, 60.0, 120.0, 240.0};

struct Pose {
  Vector3d position_m = Vector3d::Zero();
  Quaterniond turn = Quaterniond::Identity();
};

/// A filter and a clock.
struct Filtered {
  PoseFilter filter;
  HostTime now{1h};

  Pose pass(const Pose& pose, double interval_s) {
    now += std::chrono::round<HostClock::duration>(std::chrono::duration<double>(interval_s));
    PoseSample sample;
    sample.measured = now;
    sample.arrival = now + 7ms; // does not count
    Vector3d::Map(sample.position_m.data()) = pose.position_m;
    Eigen::Vector4d::Map(sample.turn_xyzw.data()) = pose.turn.coeffs();
    const PoseSample passed = filter.pass(sample);
    return {Vector3d::Map(passed.position_m.data()), Quaterniond(passed.turn_xyzw.data())};
  }
};

Quaterniond about(const Vector3d& axis, double angle_rad) {
  return Quaterniond(AngleAxisd(angle_rad, axis.normalized()));
}

/// Intervals between samples in seconds, repeated.
const std::vector<std::vector<double>> rhythms{
    {1.0 / 30}, {1.0 / 120}, {0.001}, {0.0, 2.0 / 120}, {0.011, 0.011, 0.3, 0.0, 0.002, 0.04}};

/// A movement of a person from 0 to 1 in 1 s: of least jerk (T. Flash and N. Hogan 1985). Its peak
/// speed is 1.875.
double reach(double time) {
  const double u = std::clamp(time, 0.0, 1.0);
  return u * u * u * (10.0 + u * (6.0 * u - 15.0));
}

/// Returns by how many milliseconds `moved(time_s)` must be delayed to be most like what `filtered`
/// makes of it at a rate, for a movement from 1 s to 1 + length_s.
double delay_ms(double rate_hz, double length_s, const std::function<double(double)>& moved,
                const std::function<double(double)>& filtered) {
  std::vector<double> out;
  for (int n = 0; n < (1.5 + length_s) * rate_hz; ++n)
    out.push_back(filtered(n / rate_hz));
  double best = std::numeric_limits<double>::infinity();
  double best_ms = 0.0;
  for (double late_ms = 0.0; late_ms < 80.0; late_ms += 0.25) {
    double sum = 0.0;
    for (std::size_t n = 0; n < out.size(); ++n) {
      const double time_s = static_cast<double>(n) / rate_hz;
      sum += std::pow(out[n] - moved(time_s - late_ms / 1e3), 2);
    }
    if (sum < best) {
      best = sum;
      best_ms = late_ms;
    }
  }
  return best_ms;
}

/// Returns the root mean square of one axis, in metres and radians, that is left of a FASTRAK's
/// noise at rest.
std::array<double, 2> left_at_rest(double rate_hz, double noise_m, double noise_rad) {
  Filtered filtered{PoseFilter(by_default)};
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto any = [&](double deviation) {
    const double x = normal(random);
    const double y = normal(random);
    return Vector3d(deviation * Vector3d(x, y, normal(random)));
  };
  const Pose truth{{0.4, -0.2, 0.1}, about({1, 2, 3}, 0.8)};
  double squares_m = 0.0;
  double squares_rad = 0.0;
  const int count = static_cast<int>(200 * rate_hz);
  for (int n = 0; n < count; ++n) {
    const Vector3d rotation = any(noise_rad);
    const Pose passed = filtered.pass(
        {truth.position_m + any(noise_m), about(rotation, rotation.norm()) * truth.turn},
        1.0 / rate_hz);
    if (n < rate_hz) continue;
    squares_m += (passed.position_m - truth.position_m).squaredNorm() / 3.0;
    squares_rad += std::pow(passed.turn.angularDistance(truth.turn), 2) / 3.0;
  }
  const double counted = count - rate_hz;
  return {std::sqrt(squares_m / counted), std::sqrt(squares_rad / counted)};
}

} // namespace

TEST_SUITE("pose_filter") {
  TEST_CASE("switched off it passes every number as it is") {
    Filtered filtered{PoseFilter()};
    std::mt19937 random(1);
    const auto any = [&] {
      return std::ldexp(static_cast<double>(random()), int(random() % 60) - 60);
    };
    for (int n = 0; n < 1000; ++n) {
      const Pose pose{{any(), any(), any()}, {any(), any(), any(), any()}};
      const Pose passed = filtered.pass(pose, 0.01 * static_cast<double>(random() % 200));
      REQUIRE(passed.position_m == pose.position_m);
      REQUIRE(passed.turn.coeffs() == pose.turn.coeffs());
    }
    CHECK(filtered.filter.latency().position_s == 0.0);
    CHECK(filtered.filter.latency().turn_s == 0.0);
  }

  TEST_CASE("along one line, and about one axis, it is the filter of angles") {
    const PoseFilterOptions options{FilterKind::one_euro, 1.5, 6.0, 6.0, 2.0};
    const Vector3d axis = Vector3d(2, -1, 3).normalized();
    const Vector3d line = Vector3d(1, 1, -2).normalized();
    for (const auto& rhythm : rhythms) {
      Filtered filtered{PoseFilter(options)};
      JointFilter reference({FilterKind::one_euro, 1.5, 6.0, 2.0});
      std::mt19937 random(2);
      std::normal_distribution<double> noise(0.0, 0.02);
      for (std::size_t n = 0; n < 600; ++n) {
        const double x = 0.8 * std::sin(0.03 * static_cast<double>(n)) + noise(random);
        const Pose passed = filtered.pass({x * line, about(axis, x)}, rhythm[n % rhythm.size()]);
        JointAngles angles;
        angles.wrist_yaw_rad = x;
        const double expected = reference.pass(angles, filtered.now).wrist_yaw_rad;
        REQUIRE((passed.position_m - expected * line).norm() < 1e-9);
        REQUIRE(passed.turn.angularDistance(about(axis, expected)) < 1e-7);
      }
      const double joint_s = reference.latency_s(Angle::wrist_yaw);
      CHECK(filtered.filter.latency().position_s == doctest::Approx(joint_s));
      CHECK(filtered.filter.latency().turn_s == doctest::Approx(joint_s).epsilon(1e-6));
    }
  }

  TEST_CASE("the axes that the tracker has do not matter") {
    Filtered one{PoseFilter(by_default)};
    Filtered other{PoseFilter(by_default)};
    const Quaterniond axes = about({3, -1, 2}, 2.1);
    std::mt19937 random(4);
    std::normal_distribution<double> noise(0.0, 0.01);
    Pose pose;
    for (int n = 0; n < 1000; ++n) {
      pose.position_m += Vector3d(noise(random), noise(random), noise(random));
      pose.turn =
          (about({noise(random), noise(random), noise(random)}, 10.0 * noise(random)) * pose.turn)
              .normalized();
      const Pose a = one.pass(pose, 0.008);
      const Pose b = other.pass({axes * pose.position_m, axes * pose.turn}, 0.008);
      REQUIRE((axes * a.position_m - b.position_m).norm() < 1e-12);
      REQUIRE((axes * a.turn).angularDistance(b.turn) < 1e-7);
    }
  }

  TEST_CASE("sign changes of the quaternion leave no trace") {
    Filtered one{PoseFilter(by_default)};
    Filtered other{PoseFilter(by_default)};
    std::mt19937 random(5);
    for (int n = 0; n < 3000; ++n) { // through all signs of w, and half turns
      Pose pose{Vector3d::Zero(), about({1, 2, 0.5 * std::sin(0.01 * n)}, 0.02 * n)};
      const Pose a = one.pass(pose, 0.008);
      if (random() % 2 == 0) pose.turn.coeffs() *= -1.0;
      const Pose b = other.pass(pose, 0.008);
      REQUIRE(a.turn.toRotationMatrix() == b.turn.toRotationMatrix());
      REQUIRE(one.filter.latency().turn_s == other.filter.latency().turn_s);
      REQUIRE(a.turn.angularDistance(pose.turn) < 0.1);
    }
  }

  TEST_CASE("at rest, less than a third of a FASTRAK's noise is left, at each rate") {
    constexpr double noise_m = 0.0008;
    const double noise_rad = from_degrees(0.15);
    for (const double rate_hz : rates_hz) {
      const auto [left_m, left_rad] = left_at_rest(rate_hz, noise_m, noise_rad);
      MESSAGE(rate_hz << " Hz: " << 1e3 * left_m << " mm, " << to_degrees(left_rad) << " degrees");
      CHECK(left_m <= 0.00025);
      CHECK(left_rad <= noise_rad * 0.25 / 0.8);
    }
  }

  TEST_CASE("strokes of 0.5 m/s come out at most 20 ms late, and so do turns") {
    for (const double rate_hz : rates_hz) {
      for (const double length_m : {0.05, 0.1, 0.2, 0.4}) {
        const double length_s = 1.875 * length_m / 0.5;
        const auto moved = [&](double time_s) { return reach((time_s - 1.0) / length_s); };
        Filtered stroke{PoseFilter(by_default)};
        const double stroke_ms = delay_ms(rate_hz, length_s, moved, [&](double time_s) {
          const Pose pose{Vector3d(length_m * moved(time_s), 0.3, 0.1)};
          return stroke.pass(pose, time_s > 0.0 ? 1.0 / rate_hz : 0.0).position_m.x() / length_m;
        });
        // A turn that moves a fingertip, 0.19 m from the wrist, as far.
        const double turn_rad = length_m / 0.19;
        Filtered turn{PoseFilter(by_default)};
        const double turn_ms = delay_ms(rate_hz, length_s, moved, [&](double time_s) {
          const Pose pose{Vector3d::Zero(), about({0, 1, 0}, turn_rad * moved(time_s))};
          return turn.pass(pose, time_s > 0.0 ? 1.0 / rate_hz : 0.0)
                     .turn.angularDistance(Quaterniond::Identity()) /
                 turn_rad;
        });
        CAPTURE(rate_hz);
        CAPTURE(length_m);
        MESSAGE(rate_hz << " Hz, " << length_m << " m: " << stroke_ms << " ms, turn " << turn_ms
                        << " ms");
        CHECK(stroke_ms <= 20.0);
        CHECK(turn_ms <= 20.0);
      }
    }
  }

  TEST_CASE("a steady movement comes out late by the latency that is reported") {
    for (const double speed_m_s : {0.1, 0.5, 2.0}) {
      Filtered filtered{PoseFilter(by_default)};
      double late_s = 0.0;
      for (int n = 0; n < 400; ++n) {
        const Vector3d there = Vector3d(0.6, 0.0, 0.8) * speed_m_s * n / 120.0;
        const Pose passed = filtered.pass({there}, n > 0 ? 1.0 / 120.0 : 0.0);
        late_s = (there - passed.position_m).norm() / speed_m_s;
      }
      CHECK(filtered.filter.latency().position_s == doctest::Approx(late_s).epsilon(0.01));
      const double cutoff_hz = by_default.min_cutoff_hz + by_default.beta_hz_per_m_s * speed_m_s;
      CHECK(late_s == doctest::Approx(1.0 / (tau * cutoff_hz)).epsilon(0.01));
      CHECK(filtered.filter.latency().turn_s ==
            doctest::Approx(1.0 / (tau * by_default.min_cutoff_hz)));
    }
  }

  TEST_CASE("after a pause, or with a clock that went far back, it restarts") {
    const Pose far{{-0.3, 0.2, 0.9}, about({0, 0, 1}, 3.0)};
    for (const double pause_s : {0.501, 3.0, 1e6, -0.501, -100.0}) {
      Filtered filtered{PoseFilter(by_default)};
      for (int n = 0; n < 30; ++n)
        filtered.pass({Vector3d(0.01 * n, 0, 0), about({1, 0, 0}, 0.05 * n)}, 0.008);
      const double resting_s = 1.0 / (tau * by_default.min_cutoff_hz);
      CHECK(filtered.filter.latency().position_s < 0.5 * resting_s);
      const Pose passed = filtered.pass(far, pause_s);
      CHECK(passed.position_m == far.position_m);
      CHECK(passed.turn.coeffs() == far.turn.coeffs());
      CHECK(filtered.filter.latency().position_s == doctest::Approx(resting_s));
      CHECK(filtered.filter.latency().turn_s == doctest::Approx(resting_s));
    }
    Filtered filtered{PoseFilter(by_default)};
    filtered.pass({}, 0.0);
    CHECK(filtered.pass(far, 0.499).position_m != far.position_m); // that was no pause
  }

  TEST_CASE("a time that stops or goes back a little moves nothing, and time continues") {
    for (const double interval_s : {0.0, -0.004, -0.3}) {
      Filtered filtered{PoseFilter(by_default)};
      filtered.pass({}, 0.0);
      const Pose before = filtered.pass({Vector3d(0.4, 0, 0), about({1, 0, 0}, 0.5)}, 0.01);
      const Pose next{Vector3d(0.5, 0, 0), about({1, 0, 0}, 0.6)};
      const Pose still = filtered.pass(next, interval_s);
      CHECK(still.position_m == before.position_m);
      CHECK(still.turn.angularDistance(before.turn) < 1e-7);
      CHECK(filtered.pass(next, 0.01).position_m.x() > before.position_m.x());
    }
  }

  TEST_CASE("no options, poses or times make anything that is not finite") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> strange{0.0,    -1.0,     1e-300,    1e300,
                                      -1e300, infinity, -infinity, std::nan("")};
    std::mt19937_64 random(8);
    const auto any = [&] { return strange[random() % strange.size()]; };
    const auto part = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
    for (int round = 0; round < 300; ++round) {
      Filtered filtered{PoseFilter({FilterKind::one_euro, any(), any(), any(), any()})};
      for (int n = 0; n < 60; ++n) {
        Pose pose{{3.0 * part(), 3.0 * part(), 3.0 * part()}, {part(), part(), part(), part()}};
        pose.turn = pose.turn.norm() > 0.1 ? pose.turn.normalized() : Quaterniond(0, 0, 1, 0);
        const auto ticks = random() % 2 == 0
                               ? static_cast<HostClock::rep>(random())
                               : static_cast<HostClock::rep>(random() % 1'000'000'000);
        filtered.now = HostTime(HostClock::duration(ticks));
        const Pose passed = filtered.pass(pose, 0.0);
        REQUIRE(passed.position_m.norm() <= 6.0);
        REQUIRE(passed.turn.norm() == doctest::Approx(1.0).epsilon(1e-9));
        REQUIRE(std::isfinite(filtered.filter.latency().position_s));
        REQUIRE(std::isfinite(filtered.filter.latency().turn_s));
      }
    }
  }
}

} // namespace pose_filter_test
