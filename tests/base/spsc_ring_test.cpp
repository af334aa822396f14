#include <nendo/base/spsc_ring.hpp>

#include <atomic>
#include <cstdint>
#include <deque>
#include <random>
#include <thread>

#include <doctest/doctest.h>

using nendo::SpscRing;

TEST_SUITE("spsc_ring") {
  TEST_CASE("the capacity is rounded up to a power of two") {
    CHECK(SpscRing<int>(1).capacity() == 2);
    CHECK(SpscRing<int>(5).capacity() == 8);
    CHECK(SpscRing<int>(1024).capacity() == 1024);
  }

  TEST_CASE("a full ring refuses the newest element and counts it") {
    SpscRing<int> ring(4);
    for (int i = 0; i < 4; ++i)
      CHECK(ring.try_push(i));
    CHECK_FALSE(ring.try_push(99));
    int got = -1;
    REQUIRE(ring.try_pop(got));
    CHECK(got == 0);
    CHECK(ring.try_push(4));
    const auto counters = ring.counters();
    CHECK(counters.offered == 6);
    CHECK(counters.refused == 1);
    CHECK(counters.consumed == 1);
    CHECK(ring.size() == 4);
  }

  TEST_CASE("it behaves like a bounded queue under any sequence of operations") {
    std::mt19937 random(11);
    SpscRing<std::uint32_t> ring(8);
    std::deque<std::uint32_t> model;
    std::uint64_t refused = 0;
    for (std::uint32_t n = 0; n < 20'000; ++n) {
      const auto action = random() % 8;
      if (action < 5) {
        const bool room = model.size() < 8;
        CHECK(ring.try_push(n) == room);
        if (room) model.push_back(n);
        refused += room ? 0 : 1;
      } else if (action < 7) {
        std::uint32_t got = 0;
        CHECK(ring.try_pop(got) == !model.empty());
        if (!model.empty()) {
          CHECK(got == model.front());
          model.pop_front();
        }
      } else {
        const std::size_t count = ring.drain([&](std::uint32_t got) {
          CHECK(got == model.front());
          model.pop_front();
        });
        CHECK(model.empty());
        CHECK(count <= 8);
      }
      CHECK(ring.size() == model.size());
    }
    CHECK(ring.counters().refused == refused);
    CHECK(ring.counters().offered == ring.counters().consumed + refused + model.size());
  }

  TEST_CASE("two threads: order is kept and offered = consumed + refused + held") {
    constexpr std::uint64_t rounds = 300'000;
    struct Element {
      std::uint64_t number;
      std::uint64_t check;
    };
    SpscRing<Element> ring(64);
    std::atomic<bool> done{false};
    std::thread producer([&] {
      for (std::uint64_t n = 1; n <= rounds; ++n) {
        ring.try_push({n, ~n});
        if (n % 32 == 0) std::this_thread::yield(); // one core must not starve the consumer
      }
      done = true;
    });
    std::uint64_t last = 0;
    std::uint64_t received = 0;
    bool ordered = true;
    bool whole = true;
    const auto take = [&](const Element& element) {
      ordered = ordered && element.number > last;
      whole = whole && element.check == ~element.number;
      last = element.number;
      ++received;
    };
    bool by_pop = false;
    while (!done) {
      Element element{};
      if ((by_pop = !by_pop) && ring.try_pop(element)) {
        take(element);
      } else {
        ring.drain(take);
      }
    }
    producer.join();
    ring.drain(take);
    CHECK(ordered);
    CHECK(whole);
    CHECK(received > 0);
    const auto counters = ring.counters();
    CHECK(counters.offered == rounds);
    CHECK(counters.consumed == received);
    CHECK(counters.offered == counters.consumed + counters.refused + ring.size());
  }
}
