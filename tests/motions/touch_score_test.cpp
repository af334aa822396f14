#include "motions/touch_score.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

namespace touch_score_test {

using namespace nendo;
using namespace nendo::motions;
using hand::Finger;

namespace {

constexpr std::array fingers{Finger::thumb, Finger::index, Finger::middle, Finger::ring,
                             Finger::little};

template <class Check>
void for_every_score(Check check) {
  for (const Side side : {Side::left, Side::right})
    for (std::uint32_t seed = 0; seed < 30; ++seed)
      check(TouchScore(side, seed));
}

} // namespace

TEST_SUITE("touch_score") {
  TEST_CASE("every finger presses and pulls, alone and with the others, and all glide to the end") {
    for_every_score([](const TouchScore& score) {
      std::array<int, 5> alone_in{};
      std::array<int, 5> alone_out{};
      int all_in = 0;
      int all_out = 0;
      double farthest = 0.0;
      for (double t = 0.0; t < score.period_s(); t += 0.02) {
        std::array<double, 5> depths{};
        for (std::size_t k = 0; k < 5; ++k)
          depths[k] = score.depth(fingers[k], t);
        const auto [least, most] = std::minmax_element(depths.begin(), depths.end());
        all_in += *least > 0.5 ? 1 : 0;
        all_out += *most < -0.5 ? 1 : 0;
        for (std::size_t k = 0; k < 5; ++k) {
          const auto others = [&](double away) {
            return std::count_if(depths.begin(), depths.end(),
                                 [=](double depth) { return std::abs(depth) > away; });
          };
          alone_in[k] += depths[k] > 0.5 && others(0.25) == 1 ? 1 : 0;
          alone_out[k] += depths[k] < -0.15 && others(0.06) == 1 ? 1 : 0; // without the wrist
          CHECK(std::abs(depths[k]) <= 1.0);
        }
        farthest = std::max(farthest, score.way(t));
      }
      CHECK(*std::min_element(alone_in.begin(), alone_in.end()) > 0);
      CHECK(*std::min_element(alone_out.begin(), alone_out.end()) > 0);
      CHECK(all_in > 0);
      CHECK(all_out > 0);
      CHECK(farthest == 1.0);
    });
  }

  TEST_CASE("after ten seconds all fingers hold what they have pulled out") {
    for_every_score([](const TouchScore& score) {
      for (const Finger finger : fingers)
        for (double t = 9.5; t < 10.6; t += 0.1)
          CHECK(score.depth(finger, t) == -1.0);
    });
  }

  TEST_CASE("no finger presses or pulls while it glides") {
    for_every_score([](const TouchScore& score) {
      for (double t = 0.0; t < score.period_s(); t += 0.01) {
        if (score.way(t + 0.005) == score.way(t - 0.005)) continue;
        for (const Finger finger : fingers)
          CHECK(score.depth(finger, t) == 0.0);
      }
    });
  }

  TEST_CASE("a cycle begins and ends at rest, and movements have no jump of speed or force") {
    for_every_score([](const TouchScore& score) {
      constexpr double step_s = 1e-3;
      const auto bend = [&](const auto& of, double t) {
        return std::abs(of(t - step_s) - 2.0 * of(t) + of(t + step_s)) / (step_s * step_s);
      };
      for (const Finger finger : fingers) {
        CHECK(score.depth(finger, 0.0) == 0.0);
        const auto depth = [&](double t) { return score.depth(finger, t); };
        for (double t = 0.5; t < score.period_s() + 1.0; t += 0.0137)
          CHECK(bend(depth, t) < 60.0); // 10/sqrt(3) over the square of 0.33 s
      }
      CHECK(score.way(0.0) == 0.0);
      const auto way = [&](double t) { return score.way(t); };
      for (double t = 0.5; t < score.period_s() + 1.0; t += 0.0137)
        CHECK(bend(way, t) < 20.0);
    });
  }

  TEST_CASE("extremes are where the fingers go farthest") {
    for_every_score([](const TouchScore& score) {
      const auto times = score.extremes_s();
      for (const Finger finger : fingers) {
        double at_extremes = 0.0;
        double anywhere = 0.0;
        for (const double t : times)
          at_extremes = std::max(at_extremes, score.depth(finger, t));
        for (double t = 0.0; t < score.period_s(); t += 0.01)
          anywhere = std::max(anywhere, score.depth(finger, t));
        CHECK(at_extremes == doctest::Approx(anywhere));
      }
    });
  }

  TEST_CASE("the same seed gives the same score, another seed or side another") {
    const TouchScore score(Side::left, 4);
    CHECK(score.extremes_s() == TouchScore(Side::left, 4).extremes_s());
    CHECK(score.extremes_s() != TouchScore(Side::left, 5).extremes_s());
    CHECK(score.extremes_s() != TouchScore(Side::right, 4).extremes_s());
  }
}

} // namespace touch_score_test
