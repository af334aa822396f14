#include <nendo/hand/pose_gate.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

namespace pose_gate_test {

using namespace nendo;
using namespace nendo::hand;
using namespace std::chrono_literals;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double tau = 6.283185307179586;

HostTime at_s(double time_s) {
  return HostTime(1h) + from_seconds(time_s);
}

PoseSample sample_at(double time_s, const Vector3d& position_m,
                     const Quaterniond& turn = Quaterniond::Identity()) {
  PoseSample sample;
  sample.arrival = sample.measured = at_s(time_s);
  sample.position_m = {position_m.x(), position_m.y(), position_m.z()};
  sample.turn_xyzw = {turn.x(), turn.y(), turn.z(), turn.w()};
  return sample;
}
Vector3d position_of(const PoseSample& sample) {
  return Vector3d::Map(sample.position_m.data());
}
Quaterniond turn_of(const PoseSample& sample) {
  return Quaterniond(sample.turn_xyzw.data());
}

Vector3d noise_m(std::mt19937& random, double deviation_m) {
  std::normal_distribution<double> noise(0.0, deviation_m);
  const double x = noise(random);
  const double y = noise(random);
  return {x, y, noise(random)};
}

/// A fast movement: 1.9 m/s, 18 m/s^2 and 9 rad/s at the peaks.
Vector3d stroke_m(double time_s) {
  return {0.5 + 0.2 * std::sin(tau * 1.5 * time_s), 0.1 * std::cos(tau * 0.7 * time_s), -0.2};
}
Quaterniond stroke_turn(double time_s) {
  return Quaterniond(
      Eigen::AngleAxisd(std::sin(tau * 1.5 * time_s), Vector3d(0.6, 0.0, 0.8).normalized()));
}

/// A gate that three poses have passed, at rest at 120 Hz; the next is due at `next_s`.
struct Rested {
  static constexpr double period_s = 1.0 / 120.0;
  PoseGate gate{};
  Vector3d position_m{0.4, 0.2, -0.1};
  double next_s = 0.0;

  Rested() {
    for (int n = 0; n < 3; ++n)
      REQUIRE(pass(position_m));
  }
  bool pass(const Vector3d& here_m, const Quaterniond& turn = Quaterniond::Identity(),
            char error = ' ') {
    PoseSample sample = sample_at(next_s, here_m, turn);
    sample.error = error;
    next_s += period_s;
    return gate.pass(sample).has_value();
  }
};

/// A magnetic tracker: the receiver's true position crosses the plane x = 0, and is reported at the
/// mirrored position beyond it.
struct Crossing {
  double distance_m; ///< from the transmitter at the crossing
  double rate_hz;
  double lost; ///< the fraction of the records that get lost

  static constexpr int crossings = 10; ///< five times there and back
  static constexpr double period_s = 4.0;

  Vector3d true_m(double time_s) const {
    return {0.3 * std::cos(tau * time_s / period_s), 0.8 * distance_m, -0.6 * distance_m};
  }
};

} // namespace

TEST_SUITE("pose_gate") {
  TEST_CASE("a hand's movements pass, at any rate, in bursts, and when records get lost") {
    for (const double rate_hz : {30.0, 60.0, 120.0, 240.0, 1000.0}) {
      for (const bool in_bursts : {false, true}) {
        for (const double lost : {0.0, 0.1}) {
          if (in_bursts && lost > 0.0) continue;
          PoseGate gate;
          std::mt19937 random(1);
          std::uint64_t missing = 0;
          std::uint64_t doubted = 0;
          bool was_doubted = false;
          for (int n = 0; n < 10 * rate_hz; ++n) {
            const double time_s = n / rate_hz;
            if (std::uniform_real_distribution<>(0.0, 1.0)(random) < lost) {
              ++missing;
              continue;
            }
            // An adapter that delivers every 16 ms: what it delivers at once has the same time.
            const double stamp_s = in_bursts ? std::ceil(time_s / 0.016) * 0.016 : time_s;
            PoseSample sample =
                sample_at(stamp_s, stroke_m(time_s) + noise_m(random, 0.0005), stroke_turn(time_s));
            const auto passed = gate.pass(sample);
            CAPTURE(rate_hz);
            CAPTURE(in_bursts);
            CAPTURE(n);
            // Where a record is missing, one more may be refused.
            if (std::exchange(was_doubted, !passed) || missing == 0) REQUIRE(passed);
            if (!passed) {
              ++doubted;
              continue;
            }
            REQUIRE(passed->position_m == sample.position_m);
            REQUIRE(turn_of(*passed).angularDistance(stroke_turn(time_s)) < 1e-7);
          }
          CHECK(gate.refused() == doubted);
          CHECK(3 * doubted <= missing);
          CHECK(gate.flips() == 0);
        }
      }
    }
  }

  TEST_CASE("numbers that are no pose never pass, and are counted") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Rested rested;
    std::uint64_t refused = 0;
    for (const double bad : {std::nan(""), infinity, -infinity, 3.001, -1e300}) {
      for (int axis = 0; axis < 3; ++axis) {
        Vector3d position_m = Vector3d::Zero();
        position_m[axis] = bad;
        for (int n = 0; n < 20; ++n)
          CHECK_FALSE(rested.pass(position_m));
        refused += 20;
        CHECK(rested.gate.refused() == refused);
      }
    }
    for (const Quaterniond& turn :
         {Quaterniond(0, 0, 0, 0), Quaterniond(1.003, 0, 0, 0), Quaterniond(0, 0, 0.997, 0),
          Quaterniond(1, std::nan(""), 0, 0), Quaterniond(0, infinity, 0, 0)}) {
      CHECK_FALSE(rested.pass(rested.position_m, turn));
      CHECK(rested.gate.refused() == ++refused);
    }
    CHECK(rested.pass(rested.position_m)); // such numbers were no poses, and no loss
  }

  TEST_CASE("a tracker may be allowed to reach farther") {
    PoseGate gate({.max_distance_m = 10.0});
    CHECK(gate.pass(sample_at(0.0, {0.0, 9.9, 0.0})));
    CHECK_FALSE(gate.pass(sample_at(0.01, {0.0, 10.1, 0.0})));
  }

  TEST_CASE("a quaternion of nearly unit length is normalised") {
    PoseGate gate;
    for (const double length : {0.9981, 1.0, 1.0019}) {
      const Quaterniond turn(length * 0.6, 0.0, length * 0.8, 0.0);
      const auto passed = gate.pass(sample_at(0.0, {0.4, 0.2, 0.1}, turn));
      REQUIRE(passed);
      CHECK(turn_of(*passed).norm() == doctest::Approx(1.0).epsilon(1e-15));
      CHECK(turn_of(*passed).w() == doctest::Approx(0.6));
    }
  }

  TEST_CASE("one pose elsewhere, or with another turn, is refused, and the next good one passes") {
    Rested rested;
    CHECK_FALSE(rested.pass(rested.position_m + Vector3d(0.0, 0.0, 0.010)));
    CHECK(rested.pass(rested.position_m));
    CHECK(rested.pass(rested.position_m + Vector3d(0.0, 0.0, 0.007)));
    // A flipped sign: the length is right.
    const Quaterniond turn = Quaterniond(Eigen::AngleAxisd(1.2, Vector3d::UnitX()));
    Rested turned;
    CHECK_FALSE(turned.pass(turned.position_m, turn));
    CHECK(turned.pass(turned.position_m, Quaterniond(-1.0, 0.0, 0.0, 0.0))); // the same turn
    CHECK(turned.gate.refused() == 1);
  }

  TEST_CASE("after damage that looks like a movement, the good poses pass") {
    for (const double damage_m : {0.0085, -0.0085}) {
      Rested rested;
      CHECK(rested.pass(rested.position_m + Vector3d(0.0, damage_m, 0.0)));
      for (int n = 0; n < 100; ++n)
        CHECK(rested.pass(rested.position_m));
    }
  }

  TEST_CASE("where a record is missing, a pose 12 mm off is refused once, and a good one passes") {
    const Vector3d off_m(0.0, 0.013, 0.0);
    for (const bool is_damage : {true, false}) {
      Rested rested;
      rested.next_s += 2.0 * Rested::period_s; // half of 30 m/s^2 for 25 ms are 9 mm
      CHECK_FALSE(rested.pass(rested.position_m + off_m));
      for (int n = 0; n < 20; ++n) // a hand that moved stays there
        CHECK(rested.pass(rested.position_m + (is_damage ? Vector3d(0.0, 0.0, 0.0) : off_m)));
      CHECK(rested.gate.refused() == 1);
    }
    Rested rested;
    rested.next_s += 2.0 * Rested::period_s;
    CHECK(rested.pass(rested.position_m + Vector3d(0.0, 0.011, 0.0)));
  }

  TEST_CASE("a flipped sign in a quaternion is refused, and fast turns of a hand pass") {
    for (const double rate_hz : {30.0, 60.0, 120.0}) {
      for (int component = 0; component < 4; ++component) {
        PoseGate gate;
        Quaterniond turn(0.7, 0.7, 0.7, 0.7);
        turn.coeffs()[component] = 0.06; // 0.24 rad
        turn.normalize();
        Quaterniond damaged = turn;
        damaged.coeffs()[component] *= -1.0;
        for (int n = 0; n < 40; ++n) {
          const bool is_damaged = n % 10 == 9;
          const bool passed =
              gate.pass(sample_at(n / rate_hz, {0.4, 0.2, -0.1}, is_damaged ? damaged : turn))
                  .has_value();
          CHECK(passed == !is_damaged);
        }
      }
      for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 0, 1), Vector3d(1, 2, 2)}) {
        PoseGate gate;
        const double swing_rad_s = rate_hz < 50.0 ? 20.0 : 40.0; // 12 or 24 rad/s at the peaks
        for (int n = 0; n < 10 * rate_hz; ++n) {
          const double angle_rad = 0.6 * std::sin(swing_rad_s * n / rate_hz);
          CHECK(gate.pass(sample_at(n / rate_hz, {0.4, 0.2, -0.1},
                                    Quaterniond(Eigen::AngleAxisd(angle_rad, axis.normalized())))));
        }
      }
    }
  }

  TEST_CASE("after five refusals in a row the gate gives in, and follows what comes then") {
    Rested rested;
    const Vector3d elsewhere_m = rested.position_m + Vector3d(0.0, 0.5, 0.0);
    for (int n = 0; n < 5; ++n)
      CHECK_FALSE(rested.pass(elsewhere_m));
    CHECK(rested.gate.refused() == 5);
    for (int n = 0; n < 100; ++n) // 2 m/s
      CHECK(rested.pass(elsewhere_m - Vector3d(0.0, n * 2.0 / 120.0, 0.0)));
    CHECK(rested.gate.refused() == 5);
    CHECK(rested.gate.flips() == 0);
  }

  TEST_CASE("a letter for a bad field keeps the gate from giving in, until a pause is over") {
    for (const char letter : {'j', 'k'}) {
      Rested rested;
      const Vector3d elsewhere_m = rested.position_m + Vector3d(0.0, 1.9, 0.0);
      const double end_s = rested.next_s + 0.3; // half of 30 m/s^2 for 0.3 s are 1.35 m
      while (rested.next_s < end_s)
        REQUIRE_FALSE(rested.pass(elsewhere_m, Quaterniond::Identity(), letter));
      bool passed = false;
      while (rested.next_s < end_s + 0.3)
        passed = rested.pass(elsewhere_m, Quaterniond::Identity(), letter) || passed;
      CHECK(passed);
    }
  }

  TEST_CASE("after a pause, or a clock that went far back, the hand can be anywhere") {
    for (const double pause_s : {0.6, 5.0, 1e6, -0.6, -1e6}) {
      Rested rested;
      const Quaterniond turn(0.0, 1.0, 0.0, 0.0);
      rested.next_s += pause_s;
      CHECK(rested.pass({-1.0, 2.0, 0.3}, turn));
      CHECK(rested.pass({-1.0, 2.0, 0.3}, turn));
      CHECK(rested.gate.refused() == 0);
    }
    // In a shorter one, the tolerance grows with its square.
    for (const double away_m : {0.5, 0.7}) {
      Rested rested;
      rested.next_s += 0.2 - Rested::period_s;
      CHECK(rested.pass(rested.position_m + Vector3d(away_m, 0.0, 0.0)) == (away_m < 0.6));
    }
  }

  TEST_CASE("a receiver that crosses the hemisphere five times is never seen on the wrong side") {
    for (const double distance_m : {0.04, 0.08, 0.12, 0.3}) {
      for (const double rate_hz : {30.0, 60.0, 120.0, 240.0}) {
        for (const double lost : {0.0, 0.05}) {
          const Crossing crossing{distance_m, rate_hz, lost};
          PoseGate gate;
          std::mt19937 random(7);
          std::uint64_t beyond = 0;
          std::uint64_t refused = 0;
          const double end_s = 0.5 * Crossing::crossings * Crossing::period_s;
          for (int n = 0; n < end_s * rate_hz; ++n) {
            const double time_s = n / rate_hz;
            if (std::uniform_real_distribution<>(0.0, 1.0)(random) < lost) continue;
            const Vector3d true_m = crossing.true_m(time_s) + noise_m(random, 0.0004);
            const bool is_beyond = true_m.x() < 0.0;
            const auto passed =
                gate.pass(sample_at(time_s, is_beyond ? Vector3d(-true_m) : true_m));
            CAPTURE(distance_m);
            CAPTURE(rate_hz);
            CAPTURE(time_s);
            if (passed) {
              REQUIRE((position_of(*passed) - true_m).norm() < 1e-12);
              beyond += is_beyond ? 1 : 0;
            } else {
              ++refused;
            }
          }
          CHECK(gate.flips() == beyond);
          CHECK(beyond > 9.0 * rate_hz * (1.0 - lost));
          CHECK(refused == 0);
        }
      }
    }
  }

  TEST_CASE("a hand that really passes the tracker's origin is not mirrored") {
    for (const double pause_s : {0.0, 0.1, 0.3, 0.45}) { // no poses, on both sides of the origin
      PoseGate gate;
      for (int n = 0; n < 240; ++n) {
        const double time_s = n / 120.0;
        if (std::abs(time_s - 1.0) < 0.5 * pause_s) continue;
        const PoseSample sample = sample_at(time_s, {0.8 * (time_s - 1.0), 0.003, 0.002});
        const auto passed = gate.pass(sample);
        CAPTURE(pause_s);
        CAPTURE(time_s);
        REQUIRE(passed);
        REQUIRE(passed->position_m == sample.position_m);
      }
      CHECK(gate.flips() == 0);
    }
  }

  TEST_CASE("of records with damaged bits, none passes that is far from the truth") {
    // A FASTRAK's record has seven floats in centimetres, without a checksum. A twentieth of the
    // records has one flipped bit.
    for (const double rate_hz : {60.0, 120.0}) {
      PoseGate gate;
      std::mt19937 random(11);
      int good = 0;
      int lost = 0;
      double worst_m = 0.0;
      double worst_rad = 0.0;
      for (int n = 0; n < 600 * rate_hz; ++n) {
        const double time_s = n / rate_hz;
        const double angle = tau * time_s / 12.0; // a walk round an object, 0.16 m/s
        const Vector3d true_m(0.5 + 0.3 * std::cos(angle), 0.3 * std::sin(angle), -0.1);
        const Quaterniond turn(Eigen::AngleAxisd(angle, Vector3d::UnitZ()));
        const Vector3d reported_m = true_m + noise_m(random, 0.0005);
        std::array<float, 7> floats{};
        for (int k = 0; k < 3; ++k)
          floats[static_cast<std::size_t>(k)] = static_cast<float>(100.0 * reported_m[k]);
        for (int k = 0; k < 4; ++k)
          floats[static_cast<std::size_t>(3 + k)] = static_cast<float>(turn.coeffs()[k]);
        const bool is_damaged = random() % 20 == 0;
        if (is_damaged) {
          float& damaged = floats[random() % 7];
          damaged =
              std::bit_cast<float>(std::bit_cast<std::uint32_t>(damaged) ^ (1U << random() % 32));
        }
        std::array<double, 7> numbers{};
        std::copy(floats.begin(), floats.end(), numbers.begin());
        PoseSample sample = sample_at(time_s, Vector3d::Map(numbers.data()) / 100.0);
        std::copy_n(numbers.begin() + 3, 4, sample.turn_xyzw.begin());
        const auto passed = gate.pass(sample);
        if (passed) {
          worst_m = std::max(worst_m, (position_of(*passed) - true_m).norm());
          worst_rad = std::max(worst_rad, turn_of(*passed).angularDistance(turn));
        }
        if (!is_damaged) {
          ++good;
          lost += passed ? 0 : 1;
        }
      }
      MESSAGE(rate_hz << " Hz: worst " << 1e3 * worst_m << " mm, " << worst_rad << " rad; " << lost
                      << " of " << good << " good records refused");
      CHECK(worst_m < 0.015);
      CHECK(worst_rad < 0.15);
      CHECK(lost < 0.001 * good);
    }
  }

  TEST_CASE("nothing that a device sends makes anything else than a pose") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> strange{0.0, -0.0, 1e-300,    1e300,     -1e300,
                                      3.0, -3.0, infinity,  -infinity, std::nan(""),
                                      1.0, -1.0, 0.7071068, -0.7071068};
    std::mt19937_64 random(5);
    const auto any = [&] { return strange[random() % strange.size()]; };
    PoseGate gate;
    std::uint64_t passed_count = 0;
    constexpr std::uint64_t count = 200'000;
    for (std::uint64_t n = 0; n < count; ++n) {
      PoseSample sample;
      // From one end of the clock to the other, or a few milliseconds on.
      const auto ticks = random() % 2 == 0 ? static_cast<HostClock::rep>(random())
                                           : static_cast<HostClock::rep>(random() % 1'000'000'000);
      sample.measured = HostTime(HostClock::duration(ticks));
      if (random() % 2 == 0) sample.position_m = {any(), any(), any()};
      if (random() % 2 == 0) sample.turn_xyzw = {any(), any(), any(), any()};
      const auto passed = gate.pass(sample);
      if (!passed) continue;
      ++passed_count;
      REQUIRE(position_of(*passed).norm() <= 3.0);
      REQUIRE(turn_of(*passed).norm() == doctest::Approx(1.0).epsilon(1e-12));
    }
    CHECK(passed_count > 0);
    CHECK(passed_count + gate.refused() == count);
  }
}

} // namespace pose_gate_test
