#include "simulated/hand_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/driver/simulated_glove.hpp>

#include "simulated/typical_wearer.hpp"
#include "simulated/wrist_motion.hpp"

namespace hand_motion_test {

using nendo::Sensor;
using nendo::sensor_slots;
using nendo::Side;
using nendo::driver::HandMotion;
using nendo::driver::JointAngles;
using nendo::driver::Motion;

TEST_SUITE("hand_motion") {
  namespace {
  constexpr double degree = std::numbers::pi / 180.0;
  constexpr std::array motions{Motion::rest,  Motion::wave,   Motion::pinch,
                               Motion::grasp, Motion::sculpt, Motion::faces};
  constexpr std::array sides{Side::left, Side::right};

  constexpr std::array<std::array<Sensor, 3>, 4> fingers{
      {{Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip},
       {Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip},
       {Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip},
       {Sensor::little_mcp, Sensor::little_pip, Sensor::little_dip}}};

  std::vector<double> times(double begin_s, double end_s, double step_s) {
    std::vector<double> all;
    for (int n = 0; begin_s + n * step_s < end_s; ++n)
      all.push_back(begin_s + n * step_s);
    return all;
  }

  double angle(const JointAngles& angles, Sensor sensor) {
    return angles[static_cast<std::size_t>(sensor)] / degree;
  }

  template <class Check>
  void for_every_hand(std::uint32_t seeds, Check check) {
    for (const Motion motion : motions) {
      for (const Side side : sides) {
        for (std::uint32_t seed = 0; seed < seeds; ++seed)
          check(motion, HandMotion(motion, side, seed));
      }
    }
  }
  } // namespace

  TEST_CASE("motions have the names that motion_names() lists") {
    for (const auto name : nendo::driver::motion_names())
      CHECK(nendo::driver::find_motion(name));
    CHECK(nendo::driver::motion_names().size() == motions.size() + 1); // and `table`
    CHECK(*nendo::driver::find_motion("sculpt") == Motion::sculpt);
    CHECK_FALSE(nendo::driver::find_motion("dance"));
    CHECK_FALSE(nendo::driver::find_motion(""));
  }

  TEST_CASE("on the table, the hand stays as it is while the forearm turns") {
    // The wrist turns about the vertical first, to the thumb, and then towards the palm. In the
    // tracker's axes the vertical points down, and y to the right.
    for (const Side side : sides) {
      const HandMotion motion(Motion::table, side, 1);
      const auto at = [&](double time_s) {
        const JointAngles angles = motion.at(time_s);
        const double yaw = (side == Side::right ? 1.0 : -1.0) *
                           angles[static_cast<std::size_t>(Sensor::wrist_yaw)];
        const double pitch = angles[static_cast<std::size_t>(Sensor::wrist_pitch)];
        const auto pose = nendo::driver::receiver_pose(nendo::driver::WristMotion::table,
                                                       side == Side::left ? 1 : 2, 1, time_s);
        // The fingers' direction and the thumb's (of a right hand) in the forearm's axes x, y, z.
        using Vector = std::array<double, 3>;
        const auto about_z = [](const Vector& v, double angle) {
          return Vector{std::cos(angle) * v[0] - std::sin(angle) * v[1],
                        std::sin(angle) * v[0] + std::cos(angle) * v[1], v[2]};
        };
        const auto about_y = [](const Vector& v, double angle) {
          return Vector{std::cos(angle) * v[0] + std::sin(angle) * v[2], v[1],
                        -std::sin(angle) * v[0] + std::cos(angle) * v[2]};
        };
        const auto by_pose = [&](const Vector& v) { // 2 u (u v) + (w^2 - u^2) v + 2 w u x v
          const auto& q = pose.turn_xyzw;
          const double uv = q[0] * v[0] + q[1] * v[1] + q[2] * v[2];
          const double uu = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
          const Vector cross{q[1] * v[2] - q[2] * v[1], q[2] * v[0] - q[0] * v[2],
                             q[0] * v[1] - q[1] * v[0]};
          Vector turned{};
          for (std::size_t k = 0; k < 3; ++k)
            turned[k] = 2 * uv * q[k] + (q[3] * q[3] - uu) * v[k] + 2 * q[3] * cross[k];
          return turned;
        };
        for (const Vector& v : {Vector{1, 0, 0}, Vector{0, 1, 0}, Vector{0, 0, 1}}) {
          const Vector seen = by_pose(about_z(about_y(v, -pitch), -yaw));
          for (std::size_t k = 0; k < 3; ++k)
            CHECK(seen[k] == doctest::Approx(v[k]).epsilon(1e-9));
        }
        return pitch;
      };
      double most = 0.0;
      for (double time_s = 0.0; time_s < 10.0; time_s += 0.05)
        most = std::max(most, at(time_s));
      CHECK(most > 20.0 * degree);
    }
  }

  TEST_CASE("joint ranges are those of a hand") {
    const auto most = [](Sensor sensor) {
      return nendo::driver::joint_range(sensor).max_rad / degree;
    };
    const auto least = [](Sensor sensor) {
      return nendo::driver::joint_range(sensor).min_rad / degree;
    };
    CHECK(most(Sensor::ring_mcp) == doctest::Approx(90));
    CHECK(most(Sensor::ring_pip) == doctest::Approx(105));
    CHECK(most(Sensor::ring_dip) == doctest::Approx(75));
    CHECK(most(Sensor::ring_little_abduction) == doctest::Approx(25));
    CHECK(least(Sensor::wrist_pitch) == doctest::Approx(-50));
    CHECK(least(Sensor::wrist_yaw) == doctest::Approx(-25));
    CHECK(most(Sensor::index_abduction) == 0.0);
  }

  TEST_CASE("no motion leaves a joint's range, jumps, or bends a DIP joint alone") {
    constexpr double step_s = 0.01;
    constexpr double fastest_rad_s = 15.0;
    bool in_range = true;
    bool steady = true;
    bool dip_follows = true;
    for_every_hand(12, [&](Motion, const HandMotion& hand) {
      JointAngles before = hand.at(0.0);
      for (int n = 0; n <= 6000; ++n) {
        const JointAngles now = hand.at(n * step_s);
        for (std::size_t k = 0; k < sensor_slots; ++k) {
          const auto range = nendo::driver::joint_range(static_cast<Sensor>(k));
          in_range = in_range && now[k] >= range.min_rad && now[k] <= range.max_rad;
          steady = steady && std::abs(now[k] - before[k]) < fastest_rad_s * step_s;
        }
        for (const auto& [mcp, pip, dip] : fingers) {
          dip_follows =
              dip_follows && std::abs(angle(now, dip) - angle(now, pip) * 2.0 / 3.0) < 2.0;
        }
        before = now;
      }
    });
    CHECK(in_range);
    CHECK(steady);
    CHECK(dip_follows);
  }

  TEST_CASE("angular speed has no jumps either") {
    // A jump of the speed shows as a second difference that shrinks with the step, not with its
    // square.
    const auto roughness = [](const HandMotion& hand, double step_s) {
      double most = 0.0;
      for (const double t : times(step_s, 12.0, step_s)) {
        const JointAngles a = hand.at(t - step_s);
        const JointAngles b = hand.at(t);
        const JointAngles c = hand.at(t + step_s);
        for (std::size_t k = 0; k < sensor_slots; ++k)
          most = std::max(most, std::abs(a[k] - 2 * b[k] + c[k]));
      }
      return most;
    };
    for_every_hand(1, [&](Motion, const HandMotion& hand) {
      CHECK(roughness(hand, 0.002) < 0.3 * roughness(hand, 0.004));
    });
  }

  TEST_CASE("the same seed gives the same motion, another seed another") {
    for_every_hand(3, [](Motion motion, const HandMotion& hand) {
      const HandMotion left(motion, Side::left, 1);
      CHECK(hand.at(7.3) == HandMotion(hand).at(7.3));
      CHECK(left.at(7.3) == HandMotion(motion, Side::left, 1).at(7.3));
      CHECK(left.at(7.3) != HandMotion(motion, Side::left, 2).at(7.3));
    });
  }

  TEST_CASE("every motion starts in the relaxed pose") {
    for_every_hand(20, [](Motion, const HandMotion& hand) {
      const JointAngles start = hand.at(0.0);
      for (const auto& [mcp, pip, dip] : fingers) {
        CHECK(angle(start, mcp) == doctest::Approx(25).epsilon(0.1));
        CHECK(angle(start, pip) == doctest::Approx(35).epsilon(0.1));
        CHECK(angle(start, dip) == doctest::Approx(23).epsilon(0.1));
      }
      CHECK(angle(start, Sensor::thumb_roll) == doctest::Approx(40).epsilon(0.02));
      CHECK(angle(start, Sensor::thumb_abduction) == doctest::Approx(30).epsilon(0.02));
      CHECK(start[static_cast<std::size_t>(Sensor::index_abduction)] == 0.0);
      CHECK(start[static_cast<std::size_t>(Sensor::unused)] == 0.0);
    });
  }

  TEST_CASE("a resting hand trembles by a fraction of a degree and does nothing else") {
    const HandMotion hand(Motion::rest, Side::right, 5);
    const double start = angle(hand.at(0.0), Sensor::middle_mcp);
    double least = start;
    double most = start;
    for (const double t : times(0.0, 30.0, 0.01)) {
      least = std::min(least, angle(hand.at(t), Sensor::middle_mcp));
      most = std::max(most, angle(hand.at(t), Sensor::middle_mcp));
    }
    CHECK(most - least > 0.1);
    CHECK(most - least <= 0.4);
  }

  TEST_CASE("the two hands of one seed are not in lock-step") {
    for (const Motion motion : motions) {
      if (motion == Motion::rest) continue;
      const HandMotion left(motion, Side::left, 1);
      const HandMotion right(motion, Side::right, 1);
      double apart = 0.0;
      for (const double t : times(0.0, 10.0, 0.05)) {
        apart = std::max(apart, std::abs(angle(left.at(t), Sensor::index_pip) -
                                         angle(right.at(t), Sensor::index_pip)));
      }
      CHECK(apart > 5.0);
    }
  }

  TEST_CASE("the little finger does not move without the ring finger") {
    const HandMotion hand(Motion::pinch, Side::right, 1);
    const double rest = angle(hand.at(0.0), Sensor::ring_pip);
    double ring_when_little_bends_most = 0.0;
    double little_most = 0.0;
    for (const double t : times(2.0, 8.0, 0.01)) {
      const JointAngles now = hand.at(t);
      if (angle(now, Sensor::little_pip) <= little_most) continue;
      little_most = angle(now, Sensor::little_pip);
      ring_when_little_bends_most = angle(now, Sensor::ring_pip);
    }
    CHECK(little_most > 45.0);
    CHECK(ring_when_little_bends_most > rest + 2.0);
  }

  TEST_CASE("ten seconds of sculpting leave at least three fingers of each hand well away from the "
            "start") {
    for (const Side side : sides) {
      for (std::uint32_t seed = 0; seed < 300; ++seed) {
        const HandMotion hand(Motion::sculpt, side, seed);
        const JointAngles start = hand.at(0.0);
        const JointAngles later = hand.at(10.0);
        int away = 0;
        for (const auto& [mcp, pip, dip] : fingers) {
          const double moved =
              angle(later, mcp) + angle(later, pip) - angle(start, mcp) - angle(start, pip);
          away += std::abs(moved) > 15.0 ? 1 : 0;
        }
        CHECK(away >= 3);
      }
    }
  }

  TEST_CASE("after ten seconds, and after two, a sculpting hand's wrist pulls far out") {
    for (const Side side : sides) {
      for (std::uint32_t seed = 0; seed < 300; ++seed) {
        const HandMotion hand(Motion::sculpt, side, seed);
        for (const double time_s : {2.3, 10.0})
          CHECK(angle(hand.at(time_s), Sensor::wrist_pitch) < -30.0);
      }
    }
  }

  TEST_CASE("a sculpting hand presses, pulls, and never stops") {
    for (const Side side : sides) {
      const HandMotion hand(Motion::sculpt, side, 1);
      double least = 90.0;
      double most = 0.0;
      for (const double t : times(1.0, 60.0, 0.5)) {
        double travel = 0.0;
        for (const auto& [mcp, pip, dip] : fingers) {
          travel += std::abs(angle(hand.at(t + 0.5), mcp) - angle(hand.at(t), mcp));
          least = std::min(least, angle(hand.at(t), mcp));
          most = std::max(most, angle(hand.at(t), mcp));
        }
        CHECK(travel > 1.0);
      }
      CHECK(most > 38.0);
      CHECK(least < 12.0);
    }
  }
}

TEST_SUITE("typical_wearer") {
  TEST_CASE(
      "counts are 1 to 255, and a calibration's equation gives the angles back within the noise") {
    nendo::driver::TypicalWearer wearer(3);
    for (const Motion motion : {Motion::wave, Motion::grasp, Motion::sculpt}) {
      const HandMotion hand(motion, Side::right, 3);
      for (int n = 0; n < 400; ++n) {
        const JointAngles angles = hand.at(0.05 * n);
        const auto raw = wearer.counts(angles);
        for (std::size_t k = 0; k < sensor_slots; ++k) {
          const auto sensor = static_cast<Sensor>(k);
          if (!nendo::sensors_22.has(sensor)) continue;
          REQUIRE(raw[k].value >= 1);
          REQUIRE(raw[k].value <= 255);
          const auto [offset, gain] = nendo::driver::nominal_sensor(sensor);
          REQUIRE(std::abs(gain * (raw[k].value - offset) - angles[k]) < 4.0 * gain);
        }
      }
    }
  }

  TEST_CASE("angles beyond the converter's range give its ends, never 0") {
    nendo::driver::TypicalWearer wearer(3);
    JointAngles angles{};
    angles.fill(-100.0);
    CHECK(wearer.counts(angles)[0].value == 1);
    angles.fill(100.0);
    CHECK(wearer.counts(angles)[0].value == 255);
    CHECK(wearer.counts(angles)[static_cast<std::size_t>(Sensor::unused)].value == 0);
  }

  TEST_CASE("the noise is about half a count") {
    nendo::driver::TypicalWearer wearer(3);
    JointAngles angles{};
    double sum = 0.0;
    double squares = 0.0;
    constexpr int rounds = 4000;
    for (int n = 0; n < rounds; ++n) {
      const double off = wearer.counts(angles)[21].value - 128.0;
      sum += off;
      squares += off * off;
    }
    CHECK(std::abs(sum / rounds) < 0.05);
    // Rounding to whole counts adds a variance of 1/12.
    CHECK(std::sqrt(squares / rounds) ==
          doctest::Approx(std::sqrt(0.25 + 1.0 / 12.0)).epsilon(0.1));
  }
}

} // namespace hand_motion_test
