// The laws of gestures as clutches, of hands that close and open along smooth ways.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nendo/puppet/gesture_clutch.hpp>

#include "support/test_meshes.hpp"

namespace gesture_clutch_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::puppet;

namespace {

constexpr double dt_s = 0.011;
constexpr double pi = 3.14159265358979323846;

const std::string text =
    "version = 1\nmodel = \"ball\"\n"
    "[points]\ntop = { at = [0.0, 1.0, 0.0], radius = 1.2 }\n"
    "[functions.leftIndex]\ninput = \"left.index_flexion\"\ntravel_deg = 120\n"
    "most = 3\nmove = { top = [0.0, 0.2, 0.0] }\n"
    "[functions.leftRing]\ninput = \"left.ring_flexion\"\ntravel_deg = 120\n"
    "most = 3\nmove = { top = [0.0, 0.0, 0.2] }\n"
    "[functions.rightIndex]\ninput = \"right.index_flexion\"\ntravel_deg = 120\n"
    "most = 3\nmove = { top = [0.2, 0.0, 0.0] }\n";
enum Number : std::size_t { left_index, left_ring, right_index };

std::shared_ptr<const Rig> rig_with(const std::string& clutch) {
  const auto puppet = parse_puppet(text + clutch, "p.toml");
  REQUIRE_MESSAGE(puppet, (puppet ? "" : puppet.error().message));
  return std::make_shared<const Rig>(*puppet, test::sphere(8, 16, 1.0));
}

void bend(HandState& hand, double degrees) {
  for (hand::FingerAngles& finger : hand.angles.fingers) {
    finger.mcp_flexion_rad = degrees / 3.0 * pi / 180.0;
    finger.pip_flexion_rad = finger.dip_flexion_rad = finger.mcp_flexion_rad;
  }
}

/// A player, and one beside it of the same puppet without gestures.
struct Played {
  RigPlayer player, plain;
  GestureClutch gestures;
  std::array<HandState, 2> states;
  HostTime time{1h};
  double greatest_jump = 0.0;
  int changes = 0; ///< changes of the left hand's held functions

  explicit Played(const std::string& clutch)
      : player(rig_with(clutch)), plain(rig_with(clutch)), gestures(player.rig()) {
    for (HandState& state : states)
      bend(state, 0.0);
    player.regrab(hands());
    plain.regrab(hands());
  }
  RigPlayer::Hands hands() const { return {&states[0], &states[1]}; }
  double value(std::size_t at) const { return player.values()[at]; }

  void tick() {
    const std::vector<double> before(player.values().begin(), player.values().end());
    const bool had_released = player.has_released(Side::left);
    time += std::chrono::duration_cast<HostClock::duration>(std::chrono::duration<double>(dt_s));
    gestures.watch(player, hands(), time);
    player.follow(hands());
    plain.follow(hands());
    for (const std::size_t at : {left_index, left_ring})
      greatest_jump = std::max(greatest_jump, std::abs(player.values()[at] - before[at]));
    changes += had_released != player.has_released(Side::left) ? 1 : 0;
  }
  /// The left hand goes there in that time, along half a cosine; the right one goes its own way.
  void go(double from, double to, double seconds) {
    const int ticks = static_cast<int>(std::lround(seconds / dt_s));
    for (int at = 1; at <= ticks; ++at) {
      bend(states[0], from + (to - from) * 0.5 * (1.0 - std::cos(pi * at / ticks)));
      bend(states[1],
           40.0 + 30.0 * std::sin(0.01 * static_cast<double>(time.time_since_epoch().count() /
                                                             1000000 % 100000)));
      tick();
    }
  }
  void stay(double degrees, double seconds) { go(degrees, degrees, seconds); }
};

const std::string fist = "[clutch]\nleft = \"fist\"\n";

} // namespace

TEST_SUITE("gesture_clutch") {
  TEST_CASE("a fist that is held releases the values from before it, and the next grabs") {
    Played played(fist);
    played.go(0.0, 60.0, 0.5);
    played.stay(60.0, 0.5);
    const double index = played.value(left_index), ring = played.value(left_ring);
    CHECK(index == doctest::Approx(0.5));
    played.go(60.0, 240.0, 0.3);
    played.stay(240.0, 0.6);
    CHECK(played.player.has_released(Side::left));
    CHECK_FALSE(played.player.has_released(Side::right));
    CHECK(played.value(left_index) == doctest::Approx(index).epsilon(0.01));
    CHECK(played.value(left_ring) == doctest::Approx(ring).epsilon(0.01));
    const double kept = played.value(left_index);
    played.go(240.0, 0.0, 0.4);
    played.go(0.0, 90.0, 0.5);
    played.stay(90.0, 0.5);
    CHECK(played.value(left_index) == kept); // as one lifts a mouse
    played.go(90.0, 240.0, 0.3);
    played.stay(240.0, 0.6);
    CHECK(played.player.has_released(Side::left)); // until it is open
    played.go(240.0, 10.0, 0.4);
    played.stay(10.0, 0.4);
    CHECK_FALSE(played.player.has_released(Side::left));
    CHECK(played.value(left_index) == doctest::Approx(kept).epsilon(0.02));
    const double taken = played.value(left_index);
    played.go(10.0, 70.0, 0.5);
    CHECK(played.value(left_index) == doctest::Approx(taken + 0.5).epsilon(0.02));
    CHECK(played.changes == 2);
  }

  TEST_CASE("no tick moves a function by more than the hand, or easing, does") {
    Played played(fist);
    played.go(0.0, 20.0, 0.3);
    for (int round = 0; round < 6; ++round) {
      played.go(20.0, 230.0, 0.3);
      played.stay(230.0, 0.2 + 0.15 * round);
      played.go(230.0, 20.0, 0.3);
      played.stay(20.0, 0.5);
    }
    // The hand: 210 degrees in 0.3 s of 120 a value; easing: by at most 1.75 in 0.2 s. Of each, the
    // steepest moment of a cosine, or of 3 x^2 - 2 x^3.
    const double by_hand = 210.0 / 120.0 * pi / 2.0 / 0.3 * dt_s;
    const double by_easing = 1.75 * 1.5 / GestureClutch::ease_s * dt_s;
    CHECK(played.greatest_jump < by_hand + by_easing);
    CHECK(played.greatest_jump < 0.25);
    CHECK(played.changes >= 3);
  }

  TEST_CASE("a fist that is too short leaves no trace") {
    Played played(fist);
    played.go(0.0, 60.0, 0.5);
    played.go(60.0, 230.0, 0.3);
    played.stay(230.0, 0.3);
    CHECK(played.value(left_index) < 1.0); // it does not play meanwhile
    played.go(230.0, 50.0, 0.3);
    played.stay(50.0, 0.5);
    CHECK(played.changes == 0);
    CHECK(played.value(left_index) == played.plain.values()[left_index]);
    CHECK(played.value(left_ring) == played.plain.values()[left_ring]);
  }

  TEST_CASE("trembling at a bound does not flicker") {
    for (const double about : {200.0, 0.8 * 200.0}) {
      Played played(fist);
      played.go(0.0, about, 0.4);
      for (int tick = 0; tick < 1000; ++tick) {
        bend(played.states[0], about + 15.0 * std::sin(0.9 * tick));
        played.tick();
      }
      CHECK(played.changes == (about == 200.0 ? 1 : 0));
    }
  }

  TEST_CASE("the other hand continues, bit for bit, and so do hands without gestures") {
    Played played(fist);
    for (int round = 0; round < 3; ++round) {
      played.go(0.0, 230.0, 0.3);
      played.stay(230.0, 0.7);
      CHECK(played.value(right_index) == played.plain.values()[right_index]);
      played.go(230.0, 0.0, 0.3);
    }
    Played none("");
    none.go(0.0, 240.0, 0.3);
    none.stay(240.0, 2.0);
    CHECK(none.changes == 0);
    CHECK(none.value(left_index) == none.plain.values()[left_index]);
  }

  TEST_CASE("a finger that has released by itself stays so when its hand releases and grabs") {
    Played played(fist);
    played.go(0.0, 60.0, 0.4);
    played.player.set_clutch(Side::left, 3, false, played.hands()); // the ring finger
    const double ring = played.value(left_ring);
    for (int round = 0; round < 2; ++round) {
      played.go(60.0, 230.0, 0.3);
      played.stay(230.0, 0.7);
      played.go(230.0, 60.0, 0.3);
      played.stay(60.0, 0.5);
      CHECK(played.player.has_released(Side::left) == (round == 0));
    }
    const double index = played.value(left_index);
    played.go(60.0, 100.0, 0.4);
    CHECK(played.value(left_index) > index + 0.2);
    CHECK(played.value(left_ring) == ring);
    played.player.set_clutch(Side::left, RigPlayer::all_fingers, true, played.hands());
    played.go(100.0, 130.0, 0.4);
    CHECK(played.value(left_ring) > ring + 0.1);
  }

  TEST_CASE("a finger grabs alone of a hand that has released") {
    Played played("");
    played.player.set_clutch(Side::left, RigPlayer::all_fingers, false, played.hands());
    played.player.set_clutch(Side::left, 1, true, played.hands());
    played.go(0.0, 60.0, 0.4);
    CHECK(played.value(left_index) == doctest::Approx(0.5));
    CHECK(played.value(left_ring) == 0.0);
  }

  TEST_CASE("hands without any glove, and a reset in the middle of a fist, are harmless") {
    Played played(fist);
    played.go(0.0, 230.0, 0.3);
    played.gestures.reset(played.player);
    played.stay(230.0, 2.0); // it was there before
    CHECK(played.changes == 0);
    played.gestures.watch(played.player, {nullptr, nullptr}, played.time);
    played.go(230.0, 0.0, 0.3);
    played.go(0.0, 230.0, 0.3);
    played.stay(230.0, 0.7);
    CHECK(played.changes == 1);
  }

  TEST_CASE("a pinch of a right hand's skeleton releases, an open hand and a fist do not") {
    const hand::HandSkeleton skeleton(Side::right);
    const auto strength = [&](const hand::JointAngles& angles) {
      return gesture_strength(ClutchTrigger::pinch,
                              {angles, skeleton.pose(angles, Eigen::Isometry3d::Identity()), {}});
    };
    hand::JointAngles flat{};
    CHECK(strength(flat) < -0.05);
    HandState fist_state;
    bend(fist_state, 240.0);
    CHECK(strength(fist_state.angles) < -0.03);
  }
}

} // namespace gesture_clutch_test
