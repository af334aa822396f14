#include <nendo/base/spsc_ring.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <random>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace spsc_ring_test {

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
    CHECK(counters.high_water == 4);
    CHECK(ring.size() == 4);
  }

  TEST_CASE("of elements pushed together the first ones fit, and the others are refused") {
    SpscRing<int> ring(4);
    CHECK(ring.push_n(std::array{1, 2, 3}) == 3);
    CHECK(ring.push_n(std::array{4, 5, 6}) == 1);
    CHECK(ring.push_n(std::array{7}) == 0);
    CHECK(ring.push_n({}) == 0);
    std::vector<int> got;
    ring.drain([&](int n) { got.push_back(n); });
    CHECK(got == std::vector<int>{1, 2, 3, 4});
    CHECK(ring.counters().offered == 7);
    CHECK(ring.counters().refused == 3);
  }

  TEST_CASE("claimed elements are filled in their place and appear when they are committed") {
    SpscRing<int> ring(4);
    CHECK(ring.push_n(std::array{1, 2, 3}) == 3);
    int oldest = 0;
    REQUIRE(ring.try_pop(oldest));
    REQUIRE(ring.claim(5) == 2); // one behind the third, and round the corner, where the first was
    ring.claimed(0) = 4;
    ring.claimed(1) = 5;
    CHECK(ring.size() == 2);
    ring.commit(1); // the second is not given away
    ring.refuse(3);
    std::vector<int> got;
    ring.drain([&](int n) { got.push_back(n); });
    CHECK(got == std::vector<int>{2, 3, 4});
    CHECK(ring.counters().offered == 7);
    CHECK(ring.counters().refused == 3);
    CHECK(ring.counters().consumed == 4);
  }

  TEST_CASE("it behaves like a bounded queue under any sequence of operations") {
    std::mt19937 random(11);
    SpscRing<std::uint32_t> ring(8);
    std::deque<std::uint32_t> model;
    std::uint64_t refused = 0;
    std::size_t high_water = 0;
    for (std::uint32_t n = 0; n < 20'000; ++n) {
      const auto action = random() % 9;
      if (action == 8) {
        const std::array batch{n, n + 1, n + 2};
        const std::size_t fitting = std::min<std::size_t>(3, 8 - model.size());
        CHECK(ring.push_n(batch) == fitting);
        model.insert(model.end(), batch.begin(),
                     batch.begin() + static_cast<std::ptrdiff_t>(fitting));
        refused += 3 - fitting;
      } else if (action < 5) {
        const bool fits = model.size() < 8;
        CHECK(ring.try_push(n) == fits);
        if (fits) model.push_back(n);
        refused += fits ? 0 : 1;
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
      high_water = std::max(high_water, model.size());
      CHECK(ring.counters().high_water == high_water);
    }
    CHECK(ring.counters().refused == refused);
    CHECK(ring.counters().offered == ring.counters().consumed + refused + model.size());
  }

  TEST_CASE("two threads: order is kept and offered = consumed + refused + held") {
    constexpr std::uint64_t rounds = 300'001; // a batch of two ends with it
    struct Element {
      std::uint64_t number;
      std::uint64_t check;
    };
    SpscRing<Element> ring(64);
    std::atomic<bool> done{false};
    std::thread producer([&] {
      for (std::uint64_t n = 1; n <= rounds; ++n) {
        if (n % 3 == 0) {
          ring.push_n(std::array{Element{n, ~n}, Element{n + 1, ~(n + 1)}});
          ++n;
        } else {
          ring.try_push({n, ~n});
        }
        if (n % 2048 == 0) std::this_thread::yield(); // one core must not starve the consumer
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

} // namespace spsc_ring_test
