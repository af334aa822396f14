#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "forms/timeline_view.hpp"

namespace dope_sheet_test {

using namespace nendo;
using namespace nendo::forms;

namespace {

constexpr double width = 800.0;

DopeSheet strip_of(double duration_s) {
  DopeSheet strip;
  strip.fit(width, duration_s);
  return strip;
}

StripLane lane_of(std::vector<double> keys_s) {
  return {Side::left, std::move(keys_s)};
}

} // namespace

TEST_SUITE("dope_sheet") {
  TEST_CASE("at first all of the timeline is seen, between the names and the right margin") {
    const DopeSheet strip = strip_of(4.0);
    CHECK(strip.x_of(0.0) == doctest::Approx(DopeSheet::left));
    CHECK(strip.x_of(4.0) == doctest::Approx(width - DopeSheet::right));
    CHECK(strip.x_of(1.0) - strip.x_of(0.0) == doctest::Approx(strip.x_of(4.0) - strip.x_of(3.0)));
  }

  TEST_CASE("pixels become the times that they stand for, and never one outside") {
    DopeSheet strip = strip_of(4.0);
    strip.zoom(300.0, 5.0);
    for (const double time_s : {strip.first_s(), 0.7 * strip.first_s() + 0.3 * strip.last_s()})
      CHECK(strip.time_at(strip.x_of(time_s)) == doctest::Approx(time_s));
    for (const double x : {-1e9, 0.0, width, 1e9}) {
      CHECK(strip.time_at(x) >= 0.0);
      CHECK(strip.time_at(x) <= 4.0);
    }
  }

  TEST_CASE("the time under the pointer stays there while the wheel turns") {
    for (const double x : {200.0, 400.0, 700.0}) {
      DopeSheet strip = strip_of(4.0);
      const double time_s = strip.time_at(x);
      for (int step = 0; step < 12; ++step) {
        strip.zoom(x, 1.0);
        CHECK(strip.x_of(time_s) == doctest::Approx(x));
      }
      const double seen_s = strip.last_s() - strip.first_s();
      CHECK(seen_s == doctest::Approx(4.0 * std::pow(0.8, 12)));
      strip.pan(50.0);
      CHECK(strip.x_of(time_s) == doctest::Approx(x + 50.0));
      for (int step = 0; step < 100; ++step)
        strip.zoom(x, -1.0);
      CHECK(strip.first_s() == doctest::Approx(0.0));
      CHECK(strip.last_s() == doctest::Approx(4.0));
    }
  }

  TEST_CASE("however wildly it is turned and shifted, what is seen is a part of the timeline") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> wild(-1e4, 1e4);
    for (const double duration_s : {0.0, 1e-9, 0.5, 3.0, 1e6}) {
      DopeSheet strip = strip_of(duration_s);
      for (int step = 0; step < 200; ++step) {
        strip.zoom(wild(random), wild(random) / 1e3);
        strip.pan(wild(random));
        strip.follow(wild(random) < 0.0 ? 0.0 : duration_s);
        CHECK(strip.last_s() > strip.first_s());
        CHECK(strip.first_s() >= 0.0);
        CHECK(strip.last_s() <= std::max(duration_s, DopeSheet::closest) * (1 + 1e-12));
        CHECK(std::isfinite(strip.x_of(duration_s)));
        CHECK(strip.ruler_step_s() > 0.0);
      }
    }
  }

  TEST_CASE("a play head that leaves what is seen is followed") {
    DopeSheet strip = strip_of(10.0);
    strip.zoom(DopeSheet::left, 8.0);
    const double seen_s = strip.last_s() - strip.first_s();
    strip.follow(5.0);
    CHECK(strip.first_s() == doctest::Approx(5.0));
    CHECK(strip.last_s() - strip.first_s() == doctest::Approx(seen_s));
    const double first_s = strip.first_s();
    strip.follow(5.0 + 0.5 * seen_s); // seen already
    CHECK(strip.first_s() == first_s);
  }

  TEST_CASE("the key at the pointer is the nearest of its lane within reach") {
    const DopeSheet strip = strip_of(4.0);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> when(0.0, 4.0);
    std::vector<StripLane> lanes{lane_of({}), lane_of({}), lane_of({})};
    for (std::size_t lane = 0; lane < 2; ++lane) { // the third has none
      for (int key = 0; key < 60; ++key)
        lanes[lane].keys_s.push_back(when(random));
      std::sort(lanes[lane].keys_s.begin(), lanes[lane].keys_s.end());
    }
    for (double x = 0.0; x < width; x += 3.7)
      for (std::size_t lane = 0; lane < 3; ++lane) {
        const auto found = strip.key_at(lanes, x, DopeSheet::middle_of(lane));
        double nearest = 1e300;
        for (const double time_s : lanes[lane].keys_s)
          nearest = std::min(nearest, std::abs(strip.x_of(time_s) - x));
        REQUIRE(found.has_value() == (nearest <= DopeSheet::reach));
        if (!found) continue;
        CHECK(found->lane == lane);
        CHECK(std::abs(strip.x_of(lanes[lane].keys_s[found->key]) - x) == nearest);
      }
    const double on_key = strip.x_of(lanes[0].keys_s[0]);
    CHECK_FALSE(strip.key_at(lanes, on_key, DopeSheet::ruler / 2));
    CHECK_FALSE(strip.key_at(lanes, on_key, -5.0));
    CHECK_FALSE(strip.key_at(lanes, on_key, DopeSheet::height_for(3) + 5.0));
  }

  TEST_CASE("marks are below the lanes and are found there alone") {
    const DopeSheet strip = strip_of(4.0);
    const std::vector<StripMark> marks{{1.0, "grab"}, {1.01, "commit"}, {3.0, "let_go"}};
    const double y = DopeSheet::middle_of(2);
    CHECK(strip.mark_at(marks, 2, strip.x_of(3.0) + 5.0, y) == 2U);
    CHECK(strip.mark_at(marks, 2, strip.x_of(1.01) + 1.0, y) == 1U);
    CHECK(strip.mark_at(marks, 2, strip.x_of(1.0) - 1.0, y) == 0U);
    CHECK_FALSE(strip.mark_at(marks, 2, strip.x_of(2.0), y));
    CHECK_FALSE(strip.mark_at(marks, 2, strip.x_of(3.0), DopeSheet::middle_of(1)));
  }

  TEST_CASE("pictures are at even distances over all that is seen, and stay when it is panned") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    for (const double duration_s : {0.3, 4.0, 777.7, 1e6}) {
      DopeSheet strip = strip_of(duration_s);
      for (int step = 0; step < 100; ++step) {
        strip.zoom(width * any(random), 4.0 * any(random) - 2.0);
        const auto cells = strip.cells();
        REQUIRE_FALSE(cells.empty());
        CHECK(cells.front().from_s <= strip.first_s());
        CHECK(cells.back().to_s >= strip.last_s() * (1 - 1e-12));
        CHECK(cells.back().to_s <= duration_s);
        const double length_s = cells.front().to_s - cells.front().from_s;
        for (std::size_t at = 0; at < cells.size(); ++at) {
          CHECK(cells[at].image == nullptr);
          CHECK(cells[at].from_s ==
                doctest::Approx(cells.front().from_s + static_cast<double>(at) * length_s));
          if (cells[at].to_s == duration_s) continue; // which cuts it
          const double px = strip.x_of(cells[at].to_s) - strip.x_of(cells[at].from_s);
          CHECK(px >= DopeSheet::narrowest * (1 - 1e-9));
          CHECK(px <= 2.0 * DopeSheet::narrowest * (1 + 1e-9));
        }
        strip.pan(30.0 * any(random));
        for (const StripPicture& cell : strip.cells())
          if (cell.to_s < duration_s) CHECK(std::fmod(cell.from_s, cell.to_s - cell.from_s) == 0.0);
      }
    }
    CHECK(strip_of(0.0).cells().size() == 1);
  }

  TEST_CASE("the ruler's numbers are round and do not overlap") {
    for (const double duration_s : {0.1, 0.7, 3.0, 42.0, 999.0, 1e6}) {
      const DopeSheet strip = strip_of(duration_s);
      const double step_s = strip.ruler_step_s();
      CHECK(strip.x_of(step_s) - strip.x_of(0.0) >= 63.9);
      CHECK(strip.x_of(step_s) - strip.x_of(0.0) < 200.0);
      double leading = step_s;
      while (leading < 0.99)
        leading *= 10.0;
      while (leading > 9.9)
        leading /= 10.0;
      CHECK((std::abs(leading - 1.0) < 1e-6 || std::abs(leading - 2.0) < 1e-6 ||
             std::abs(leading - 5.0) < 1e-6));
    }
  }
}

} // namespace dope_sheet_test
