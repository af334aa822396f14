#include <nendo/flow/pacer.hpp>

#include <random>

#include <doctest/doctest.h>

namespace tick_grid_test {

using namespace nendo;
using namespace nendo::flow;
using namespace std::chrono_literals;

namespace {
constexpr HostTime start(1000s + 17ns);
} // namespace

TEST_SUITE("tick_grid") {
  TEST_CASE("90 Hz does not drift: a day of ticks takes a day, to the nanosecond") {
    const TickGrid grid(start, 90.0);
    CHECK(grid.deadline(0) == start);
    CHECK(grid.deadline(90ULL * 86'400) == start + 24h);
    CHECK(grid.deadline(90ULL * 86'400 * 366) == start + 24h * 366);
  }

  TEST_CASE("neighbouring deadlines are a period apart to a nanosecond") {
    const TickGrid grid(start, 90.0);
    for (std::uint64_t tick = 0; tick < 10'000; ++tick) {
      const auto period = grid.deadline(tick + 1) - grid.deadline(tick);
      REQUIRE(period >= 11'111'111ns);
      REQUIRE(period <= 11'111'112ns);
    }
  }

  TEST_CASE("first_after is the inverse of deadline, also after decades") {
    std::mt19937_64 random(3);
    for (const double rate_hz : {1.0, 59.94, 90.0, 1000.0, 10'000.0}) {
      const TickGrid grid(start, rate_hz);
      for (int round = 0; round < 500; ++round) {
        const auto most = static_cast<std::uint64_t>(rate_hz * 1e9) >> (random() % 40);
        const std::uint64_t tick = random() % (most + 1);
        REQUIRE(grid.first_after(grid.deadline(tick)) == tick + 1);
        REQUIRE(grid.first_after(grid.deadline(tick) - 1ns) == tick);
      }
      CHECK(grid.first_after(start - 1h) == 0);
    }
  }

  TEST_CASE("sleeping until an absolute time ends after it, at once if it has passed") {
    const HostTime before = HostClock::now();
    sleep_until(before + 3ms);
    CHECK(HostClock::now() >= before + 3ms);
    sleep_until(before); // must return
    sleep_until(HostTime{});
    CHECK(HostClock::now() < before + 10s);
  }
}

} // namespace tick_grid_test
