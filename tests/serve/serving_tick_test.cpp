// A tick whose input and hands are shared is a tick like any other: no allocation, no lock, no
// system call; whatever the clients do.

#include <atomic>
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "serve_fixtures.hpp"
#include "support/flow_fixtures.hpp"
#include "support/restraint.hpp"
#include "support/sleep_only.hpp"

namespace serving_tick_test {

using namespace nendo;

namespace {

void move_and_tick(test::LoopUnderTest& test, std::uint64_t first, std::uint64_t ticks) {
  const HostTime begin = HostClock::now();
  for (std::uint64_t tick = first; tick < first + ticks; ++tick) {
    test.bend(static_cast<int>(tick % 30), begin + tick * std::chrono::milliseconds(1));
    test.loop->tick(tick, HostClock::now());
  }
}

} // namespace

TEST_SUITE("serving_tick") {
  TEST_CASE("with clients that watch samples and hands no tick allocates, locks or calls the "
            "system") {
    if (!test::restraint_is_counted) return;
    const test::ServedHands served;
    test::LoopFixture fixture;
    fixture.rings_of_ball = 8;
    fixture.input_log = &served.server->input();
    test::LoopUnderTest test(flow::Mode::type1, fixture);
    test.options.sinks.push_back(&served.server->frames());
    test.loop =
        std::make_unique<flow::DeformLoop>(test.model, test.placement, test.inputs, test.options);
    test::LineClient reading(served.server->path());
    const test::LineClient stalled(served.server->path());
    const std::string request = R"({"class":"WATCH","samples":true,"hands":true,"rate_hz":1000})";
    CHECK(stalled.send(request + "\n"));
    reading.ask(request);
    std::atomic<std::uint64_t> lines{0};
    std::thread reader([&] {
      while (reading.next_text())
        ++lines;
    });
    bool is_filtered = false;
    test::StoppedCalls calls;
    test::RestraintCounts counts;
    std::thread([&] {
      move_and_tick(test, 0, 100);
      is_filtered = test::allow_sleep_only();
      {
        const test::Restraint restraint;
        move_and_tick(test, 100, 2000);
        counts = restraint.counts();
        calls = test::stopped_calls();
      }
      if (is_filtered) test::end_thread();
    }).join();
    REQUIRE(is_filtered);
    CHECK(calls.count == 0);
    CHECK(counts.allocations + counts.frees + counts.locks == 0);
    CHECK(test::eventually([&] { return lines > 10; }));
    reading.end_all();
    reader.join();
  }
}

} // namespace serving_tick_test
