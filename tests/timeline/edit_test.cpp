#include <limits>

#include <doctest/doctest.h>

#include <nendo/hand/joint_limits.hpp>

#include "support/timelines.hpp"
#include "timeline/edit.hpp"
#include "timeline/hand_curve.hpp"

namespace edit_test {

using namespace nendo;
using namespace nendo::timeline;

namespace {

Timeline some_timeline(unsigned seed = 1) {
  std::mt19937 random(seed);
  Timeline made = test::random_timeline(random);
  // Within the limits of a hand.
  for (HandTrack& hand : made.hands)
    for (Key& key : hand.keys)
      for (std::size_t at = 0; at < hand::angle_count; ++at) {
        const auto angle = hand::angle_at(at);
        const auto& limit = hand::limit_of(angle);
        key.angles[angle] = std::clamp(key.angles[angle], limit.min_rad, limit.max_rad);
      }
  REQUIRE(complaint_about(made).empty());
  return made;
}

Eigen::Matrix<double, 3, 5> tips_of(const HandTrack& hand, const Key& key) {
  return hand.skeleton().pose(key.angles, key.wrist_pose()).fingertip_positions();
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

} // namespace

TEST_SUITE("edit") {
  TEST_CASE("a key that is moved there and back is where it was, in order on the way") {
    const Timeline before = some_timeline();
    Timeline edited = before;
    const double time_s = before.hands[0].keys[1].time_s;
    const double to_s = before.hands[0].keys[3].time_s + 0.001;
    REQUIRE(move_key(edited, Side::left, 1, to_s));
    CHECK(edited.hands[0].keys[3].time_s == to_s);
    CHECK(complaint_about(edited).empty());
    CHECK_FALSE(test::same_bits(edited, before));
    REQUIRE(move_key(edited, Side::left, 3, time_s));
    CHECK(test::same_bits(edited, before));
  }

  TEST_CASE("a key that is copied, deleted and copied back is the same") {
    const Timeline before = some_timeline();
    Timeline edited = before;
    const double time_s = before.hands[1].keys[2].time_s;
    REQUIRE(copy_key(edited, Side::right, 2, time_s + 0.002));
    REQUIRE(delete_key(edited, Side::right, 2));
    CHECK(edited.hands[1].keys.size() == before.hands[1].keys.size());
    REQUIRE(copy_key(edited, Side::right, 2, time_s));
    REQUIRE(delete_key(edited, Side::right, 3));
    CHECK(test::same_bits(edited, before));
  }

  TEST_CASE("a time after the end by a tick at most is the end, or just before the key there") {
    Timeline edited = some_timeline();
    std::vector<Key>& keys = edited.hands[1].keys;
    const double end_s = edited.duration_s;
    const double tick_s = 1.0 / edited.rate_hz;
    while (keys.back().time_s >= end_s)
      keys.pop_back();
    REQUIRE_FALSE(keys.empty());
    const auto placed = [&](double time_s) { return time_near_end(edited, Side::right, time_s); };
    for (const double inside_s : {0.0, 0.5 * end_s, end_s})
      CHECK(placed(inside_s) == inside_s);
    CHECK(placed(end_s + 0.9 * tick_s) == end_s);
    CHECK(placed(end_s + 1.1 * tick_s) == end_s + 1.1 * tick_s);
    CHECK_FALSE(copy_key(edited, Side::right, 0, placed(end_s + 1.1 * tick_s)));
    REQUIRE(copy_key(edited, Side::right, 0, placed(end_s + 0.9 * tick_s)));
    REQUIRE(keys.back().time_s == end_s);
    const std::size_t last = keys.size() - 1;
    CHECK(time_near_end(edited, Side::right, end_s + 0.9 * tick_s, last) == end_s);
    REQUIRE(copy_key(edited, Side::right, 0, placed(end_s + 0.9 * tick_s)));
    CHECK(keys[last].time_s == doctest::Approx(end_s - 0.5 * tick_s));
    CHECK(keys.back().time_s == end_s);
    CHECK(complaint_about(edited).empty());
  }

  TEST_CASE("an added key is on the curve") {
    Timeline edited = some_timeline();
    const Key wanted = HandCurve(edited.hands[0].keys).at(0.005);
    REQUIRE(add_key(edited, Side::left, 0.005));
    CHECK(same_bits(edited.hands[0].keys[1], wanted));
  }

  TEST_CASE("what was made slower and faster again is as it was") {
    const Timeline before = some_timeline();
    for (const double scale : {2.0, 0.25, 3.7}) {
      Timeline edited = before;
      const double from_s = before.hands[0].keys[1].time_s;
      const double to_s = before.hands[0].keys[4].time_s;
      REQUIRE(retime(edited, scale, from_s, to_s));
      CHECK(edited.duration_s ==
            doctest::Approx(before.duration_s + (scale - 1.0) * (to_s - from_s)));
      CHECK(edited.hands[0].keys[1].time_s == from_s);
      CHECK(edited.hands[0].keys[4].time_s == doctest::Approx(from_s + scale * (to_s - from_s)));
      REQUIRE(retime(edited, 1.0 / scale, from_s, from_s + scale * (to_s - from_s)));
      CHECK(edited.duration_s == doctest::Approx(before.duration_s).epsilon(1e-12));
      for (std::size_t hand = 0; hand < 2; ++hand)
        for (std::size_t key = 0; key < before.hands[hand].keys.size(); ++key)
          CHECK(edited.hands[hand].keys[key].time_s ==
                doctest::Approx(before.hands[hand].keys[key].time_s).epsilon(1e-12));
      for (std::size_t event = 0; event < before.events.size(); ++event)
        CHECK(edited.events[event].time_s ==
              doctest::Approx(before.events[event].time_s).epsilon(1e-12));
    }
  }

  TEST_CASE("in a mirror each fingertip is its mirror image, and twice mirrored is as before") {
    const Timeline before = some_timeline();
    constexpr double plane_x_m = 0.25;
    Timeline edited = before;
    REQUIRE(mirror(edited, plane_x_m));
    for (const HandTrack& hand : before.hands) {
      const Side other = hand.side == Side::left ? Side::right : Side::left;
      const HandTrack* mirrored = edited.track(other);
      REQUIRE(mirrored != nullptr);
      for (std::size_t key = 0; key < hand.keys.size(); ++key) {
        auto wanted = tips_of(hand, hand.keys[key]);
        wanted.row(0) = 2.0 * plane_x_m - wanted.row(0).array();
        CHECK((tips_of(*mirrored, mirrored->keys[key]) - wanted).norm() < 1e-12);
      }
    }
    REQUIRE(mirror(edited, plane_x_m));
    for (std::size_t hand = 0; hand < 2; ++hand) {
      CHECK(edited.hands[hand].side == before.hands[hand].side);
      for (std::size_t key = 0; key < before.hands[hand].keys.size(); ++key) {
        const Key& is = edited.hands[hand].keys[key];
        const Key& was = before.hands[hand].keys[key];
        CHECK((is.wrist_m - was.wrist_m).norm() < 1e-14);
        CHECK(is.wrist_turn.coeffs() == was.wrist_turn.coeffs());
      }
    }
  }

  TEST_CASE("a blend is one, the other, or in between") {
    const Timeline one = some_timeline(1);
    const Timeline other = some_timeline(2);
    Timeline edited = one;
    REQUIRE(blend(edited, other, 0.0));
    CHECK(test::same_bits(edited, one));
    for (const double factor : {0.25, 1.0}) {
      edited = one;
      REQUIRE(blend(edited, other, factor));
      for (std::size_t hand = 0; hand < 2; ++hand) {
        const HandCurve from(one.hands[hand].keys);
        const HandCurve to(other.hands[hand].keys);
        for (const Key& key : edited.hands[hand].keys)
          for (std::size_t at = 0; at < hand::angle_count; ++at) {
            const auto angle = hand::angle_at(at);
            CHECK(key.angles[angle] ==
                  doctest::Approx((1.0 - factor) * from.at(key.time_s).angles[angle] +
                                  factor * to.at(key.time_s).angles[angle]));
          }
      }
    }
    Timeline alone = other;
    alone.hands.erase(alone.hands.begin());
    edited = one;
    edited.hands.pop_back();
    edited.sculptor.deformer.supports.own.clear();
    CHECK_FALSE(blend(edited, alone, 0.5));
  }

  TEST_CASE("a blend follows the other up to the end, also where its keys lie behind it") {
    // Between two keys a curve is straight, and so is what is mixed of a still hand and of one.
    const Timeline some = some_timeline();
    Timeline one = some;
    one.duration_s = 5.0;
    Timeline other = one;
    other.duration_s = 10.0;
    for (std::size_t hand = 0; hand < 2; ++hand) {
      one.hands[hand].keys.resize(1);
      auto& keys = other.hands[hand].keys;
      keys.resize(2);
      keys[0] = one.hands[hand].keys[0];
      keys[1].time_s = 10.0;
    }
    for (const double factor : {0.25, 1.0}) {
      CAPTURE(factor);
      Timeline edited = one;
      REQUIRE(blend(edited, other, factor));
      CHECK(complaint_about(edited).empty());
      CHECK(edited.duration_s == 5.0);
      for (std::size_t hand = 0; hand < 2; ++hand) {
        const Key& still = one.hands[hand].keys[0];
        const HandCurve to(other.hands[hand].keys);
        const HandCurve made(edited.hands[hand].keys);
        for (int step = 0; step <= 100; ++step) {
          const double time_s = 0.05 * step;
          const Key is = made.at(time_s);
          const Key other_is = to.at(time_s);
          const Eigen::Vector3d wanted_m =
              still.wrist_m + factor * (other_is.wrist_m - still.wrist_m);
          CHECK((is.wrist_m - wanted_m).norm() < 1e-12);
          for (std::size_t at = 0; at < hand::angle_count; ++at) {
            const auto angle = hand::angle_at(at);
            CHECK(is.angles[angle] ==
                  doctest::Approx(still.angles[angle] +
                                  factor * (other_is.angles[angle] - still.angles[angle])));
          }
          if (factor == 1.0) CHECK(is.wrist_turn.angularDistance(other_is.wrist_turn) < 1e-6);
        }
      }
    }
  }

  TEST_CASE("a blend keeps what a hand's own keys after the end make of the time before it") {
    const Timeline other = some_timeline(2);
    Timeline one = some_timeline(1);
    for (HandTrack& hand : one.hands) {
      hand.keys.erase(hand.keys.begin() + 1, hand.keys.end());
      hand.keys[0].time_s = 9.0; // it is where this one is, all the time
    }
    one.duration_s = 2.0;
    Timeline edited = one;
    REQUIRE(blend(edited, other, 0.5));
    CHECK(complaint_about(edited).empty());
    for (std::size_t hand = 0; hand < 2; ++hand) {
      REQUIRE_FALSE(edited.hands[hand].keys.empty());
      CHECK(edited.hands[hand].keys.back().time_s <= 2.0);
      const Eigen::Vector3d wanted_m = 0.5 * one.hands[hand].keys[0].wrist_m +
                                       0.5 * HandCurve(other.hands[hand].keys).at(2.0).wrist_m;
      CHECK((HandCurve(edited.hands[hand].keys).at(2.0).wrist_m - wanted_m).norm() < 1e-12);
    }
  }

  TEST_CASE("a blend that is refused for the second hand has not changed the first") {
    Timeline edited = some_timeline(1);
    const Timeline before = edited;
    Timeline other = some_timeline(2);
    other.hands[1].keys.back().wrist_m.x() = not_a_number;
    other.hands[1].keys.back().time_s = 0.001 + other.hands[1].keys[4].time_s;
    edited.duration_s = 100.0;
    REQUIRE_FALSE(blend(edited, other, 0.5));
    edited.duration_s = before.duration_s;
    CHECK(test::same_bits(edited, before));
  }

  TEST_CASE("a key blended with its neighbours goes to where they would have it") {
    const Timeline before = some_timeline();
    Timeline edited = before;
    REQUIRE(blend_key(edited, Side::left, 2, 0.0));
    CHECK(test::same_bits(edited, before));
    REQUIRE(blend_key(edited, Side::left, 2, 1.0));
    Timeline deleted = before;
    REQUIRE(delete_key(deleted, Side::left, 2));
    const double time_s = before.hands[0].keys[2].time_s;
    const Key wanted = HandCurve(deleted.hands[0].keys).at(time_s);
    CHECK((edited.hands[0].keys[2].wrist_m - wanted.wrist_m).norm() < 1e-12);
    CHECK(edited.hands[0].keys[2].angles.thumb_roll_rad ==
          doctest::Approx(wanted.angles.thumb_roll_rad));
    CHECK_FALSE(blend_key(edited, Side::left, 0, 0.5));
    CHECK_FALSE(blend_key(edited, Side::left, 5, 0.5));
  }

  TEST_CASE("a fingertip comes to its target, and no other finger moves") {
    std::mt19937 random(5);
    for (unsigned round = 0; round < 20; ++round) {
      Timeline edited = some_timeline(10 + round);
      const auto number = round % hand::finger_count;
      const auto finger = static_cast<hand::Finger>(number);
      HandTrack& hand = edited.hands[round % 2];
      const Key before = hand.keys[3];
      // Where this finger can be: the tip of another pose of the same wrist.
      Key other = before;
      for (std::size_t at = 0; at < hand::angle_count - 3; ++at) { // not palm and wrist
        const auto& limit = hand::limit_of(hand::angle_at(at));
        std::uniform_real_distribution<double> within(limit.min_rad, limit.max_rad);
        other.angles[hand::angle_at(at)] = within(random);
      }
      const Eigen::Vector3d target_m = tips_of(hand, other).col(static_cast<Eigen::Index>(number));
      constexpr double within_m = 1e-4;
      const auto set = set_tip(edited, hand.side, 3, finger, target_m, within_m);
      CAPTURE((set ? std::string() : set.error().message));
      REQUIRE(set);
      const auto tips = tips_of(hand, hand.keys[3]);
      const double off_m = (tips.col(static_cast<Eigen::Index>(number)) - target_m).norm();
      CHECK(off_m <= within_m);
      CHECK(set->off_m == doctest::Approx(off_m));
      const auto tips_before = tips_of(hand, before);
      for (Eigen::Index at = 0; at < 5; ++at)
        if (at != static_cast<Eigen::Index>(number)) CHECK(tips.col(at) == tips_before.col(at));
    }
  }

  TEST_CASE("a place out of reach is refused with the distance that is left, which is the least") {
    Timeline edited = some_timeline();
    const Timeline before = edited;
    HandTrack& hand = edited.hands[1];
    const Eigen::Vector3d wrist_m = hand.keys[0].wrist_m;
    const auto set = set_tip(edited, Side::right, 0, hand::Finger::index,
                             wrist_m + Eigen::Vector3d(0, 2.0, 0), 1e-3);
    REQUIRE_FALSE(set);
    CHECK(set.error().message.starts_with("right hand, key 0: out of reach"));
    // A hand is no longer than its length, and the wrist turns about its end.
    const auto at = set.error().message.find("comes is ");
    REQUIRE(at != std::string::npos);
    const double off_mm = std::stod(set.error().message.substr(at + 9));
    CHECK(off_mm > 2000.0 - 1.2 * 1000.0 * hand.size.length_m);
    CHECK(off_mm < 2000.0 + 1.2 * 1000.0 * hand.size.length_m);
    CHECK(test::same_bits(edited, before));
  }

  TEST_CASE("what cannot be is refused in one line, and nothing changes") {
    const Timeline before = some_timeline();
    Timeline edited = before;
    const double there_s = before.hands[0].keys[1].time_s;
    const Eigen::Vector3d nowhere(not_a_number, 0, 0);
    std::vector<Result<void>> results;
    results.push_back(move_key(edited, Side::left, 99, 0.1));
    results.push_back(move_key(edited, Side::left, 0, there_s));
    results.push_back(move_key(edited, Side::left, 0, not_a_number));
    results.push_back(copy_key(edited, Side::left, 0, -1.0));
    results.push_back(copy_key(edited, Side::left, 0, 1e9));
    results.push_back(delete_key(edited, Side::right, 6));
    results.push_back(add_key(edited, Side::left, there_s));
    results.push_back(retime(edited, 0.0, 0.0, 1.0));
    results.push_back(retime(edited, not_a_number, 0.0, 1.0));
    results.push_back(retime(edited, 2.0, 1.0, 0.5));
    results.push_back(retime(edited, 2.0, not_a_number, not_a_number));
    results.push_back(blend_key(edited, Side::left, 2, 2.0));
    results.push_back(blend(edited, before, not_a_number));
    results.push_back(mirror(edited, not_a_number));
    results.push_back(mirror(edited, 1e300));
    for (const Eigen::Vector3d& place : {nowhere, Eigen::Vector3d(1e300, 0, 0)}) {
      const auto set = set_tip(edited, Side::left, 0, hand::Finger::thumb, place, 1e-3);
      results.push_back(set ? Result<void>() : Result<void>(set.error()));
    }
    for (const auto& result : results) {
      REQUIRE_FALSE(result);
      CHECK(result.error().code == Errc::usage);
      CHECK_FALSE(result.error().message.empty());
      CHECK(result.error().message.find('\n') == std::string::npos);
    }
    CHECK(test::same_bits(edited, before));
    edited.hands.erase(edited.hands.begin());
    CHECK_FALSE(delete_key(edited, Side::left, 0));
    while (edited.hands[0].keys.size() > 1)
      REQUIRE(delete_key(edited, Side::right, 0));
    CHECK_FALSE(delete_key(edited, Side::right, 0));
  }
}

} // namespace edit_test
