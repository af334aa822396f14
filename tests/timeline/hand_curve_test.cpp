#include <doctest/doctest.h>

#include "support/timelines.hpp"
#include "timeline/hand_curve.hpp"

namespace hand_curve_test {

using namespace nendo;
using namespace nendo::timeline;

namespace {

std::vector<Key> random_keys(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<double> step(0.05, 1.0);
  std::vector<Key> keys;
  double time_s = 0.5;
  for (; keys.size() < count; time_s += step(random))
    keys.push_back(test::random_key(time_s, random));
  return keys;
}

} // namespace

TEST_SUITE("hand_curve") {
  TEST_CASE("at a key it is the key, before the first and after the last those") {
    std::mt19937 random(1);
    const auto keys = random_keys(random, 12);
    const HandCurve curve(keys);
    for (const Key& key : keys)
      CHECK(same_bits(curve.at(key.time_s), key));
    CHECK(curve.at(-1.0).angles.palm_arch_rad == keys.front().angles.palm_arch_rad);
    CHECK(curve.at(1e9).wrist_m == keys.back().wrist_m);
    const HandCurve single({keys[3]});
    CHECK(single.at(0.0).wrist_m == keys[3].wrist_m);
  }

  TEST_CASE("between two keys every number is between theirs, and the wrist's turn is a turn") {
    std::mt19937 random(2);
    const auto keys = random_keys(random, 20);
    const HandCurve curve(keys);
    for (std::size_t at = 0; at + 1 < keys.size(); ++at) {
      const Key& from = keys[at];
      const Key& to = keys[at + 1];
      for (double t = 0.0; t <= 1.0; t += 0.05) {
        const Key key = curve.at(from.time_s + t * (to.time_s - from.time_s));
        for (std::size_t angle = 0; angle < hand::angle_count; ++angle) {
          const auto named = hand::angle_at(angle);
          CHECK(key.angles[named] >= std::min(from.angles[named], to.angles[named]));
          CHECK(key.angles[named] <= std::max(from.angles[named], to.angles[named]));
        }
        CHECK(key.wrist_turn.norm() == doctest::Approx(1.0));
        CHECK(key.wrist_turn.angularDistance(from.wrist_turn) <=
              to.wrist_turn.angularDistance(from.wrist_turn) + 1e-6);
      }
    }
  }

  TEST_CASE("even motion stays even, and slopes do not jump at keys") {
    std::vector<Key> even(5);
    for (std::size_t at = 0; at < even.size(); ++at) {
      even[at].time_s = 0.1 * static_cast<double>(at * at + at);
      even[at].angles.palm_arch_rad = 0.5 * even[at].time_s - 1.0;
    }
    const HandCurve line(even);
    for (double time_s = 0.0; time_s < 2.0; time_s += 0.01)
      CHECK(line.at(time_s).angles.palm_arch_rad == doctest::Approx(0.5 * time_s - 1.0));

    std::mt19937 random(3);
    const auto keys = random_keys(random, 20);
    const HandCurve curve(keys);
    constexpr double h = 1e-7;
    for (std::size_t at = 1; at + 1 < keys.size(); ++at) {
      const auto pip = [&](double time_s) {
        return curve.at(time_s).angles[hand::Finger::index].pip_flexion_rad;
      };
      const double time_s = keys[at].time_s;
      const double before = (pip(time_s) - pip(time_s - h)) / h;
      const double after = (pip(time_s + h) - pip(time_s)) / h;
      CHECK(before == doctest::Approx(after).epsilon(1e-3).scale(1.0));
    }
  }
}

} // namespace hand_curve_test
