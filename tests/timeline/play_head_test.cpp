#include <limits>

#include <doctest/doctest.h>

#include "timeline/play_head.hpp"

namespace play_head_test {

using nendo::timeline::PlayHead;

TEST_SUITE("play_head") {
  TEST_CASE("it moves by the time that passes, times its speed, and pauses at the end") {
    PlayHead head;
    head.advance(1.0, 3.0);
    CHECK(head.time_s() == 0.0);
    head.toggle(3.0);
    head.set_speed(0.5);
    head.advance(1.0, 3.0);
    CHECK(head.time_s() == 0.5);
    head.advance(100.0, 3.0);
    CHECK(head.time_s() == 3.0);
    CHECK_FALSE(head.is_playing());
    head.toggle(3.0); // from the beginning
    CHECK(head.time_s() == 0.0);
    CHECK(head.is_playing());
  }

  TEST_CASE("in a loop it continues from the beginning") {
    PlayHead head;
    head.set_loops(true);
    head.toggle(2.0);
    for (int step = 0; step < 10; ++step)
      head.advance(0.75, 2.0);
    CHECK(head.is_playing());
    CHECK(head.time_s() == doctest::Approx(1.5)); // 7.5 of 2
    head.advance(1.0, 0.0);                       // nothing to loop in
    CHECK(head.time_s() == 0.0);
    CHECK_FALSE(head.is_playing());
  }

  TEST_CASE("it stays in a timeline that became shorter, and refuses what is no number") {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    PlayHead head;
    head.seek(5.0, 3.0);
    CHECK(head.time_s() == 3.0);
    head.seek(-1.0, 3.0);
    CHECK(head.time_s() == 0.0);
    head.seek(2.0, 3.0);
    head.seek(nan, 3.0);
    head.set_speed(nan);
    CHECK(head.speed() == 1.0);
    CHECK(head.time_s() == 2.0);
    head.advance(0.0, 1.0);
    CHECK(head.time_s() == 1.0);
    for (const double wild : {1e9, -1.0}) {
      head.set_speed(wild);
      CHECK(head.speed() >= PlayHead::min_speed);
      CHECK(head.speed() <= PlayHead::max_speed);
    }
  }
}

} // namespace play_head_test
