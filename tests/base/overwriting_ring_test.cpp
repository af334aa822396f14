#include <nendo/base/overwriting_ring.hpp>

#include <atomic>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace overwriting_ring_test {

using nendo::OverwritingRing;

TEST_SUITE("overwriting_ring") {
  TEST_CASE("a full ring overwrites its oldest elements, and counts those that nobody had") {
    OverwritingRing<int> ring(4);
    for (int n = 0; n < 11; ++n)
      ring.push(n);
    std::vector<int> got;
    CHECK(ring.drain([&](int n) { got.push_back(n); }) == 4);
    CHECK(got == std::vector<int>{7, 8, 9, 10});
    const auto counters = ring.counters();
    CHECK(counters.pushed == 11);
    CHECK(counters.got == 4);
    CHECK(counters.lost == 7);
    int none = 0;
    CHECK_FALSE(ring.try_pop(none));
  }

  TEST_CASE("an element of any size comes out as it went in") {
    struct Odd {
      char text[13] = "";
      bool operator==(const Odd& other) const = default;
    };
    OverwritingRing<Odd> ring(2);
    const Odd in{"twelve bytes"};
    ring.push(in);
    Odd out;
    REQUIRE(ring.try_pop(out));
    CHECK(out == in);
  }

  TEST_CASE("it has the newest elements, whatever the sequence of operations") {
    constexpr std::uint64_t capacity = 8;
    std::mt19937 random(3);
    OverwritingRing<std::uint64_t> ring(capacity);
    std::uint64_t pushed = 0;
    std::uint64_t next = 0; // the model: an element is there if it is one of the last eight
    std::uint64_t got = 0;
    for (int n = 0; n < 20'000; ++n) {
      if (random() % 16 < 9) {
        ring.push(pushed++);
        continue;
      }
      const std::uint64_t expected = pushed > next + capacity ? pushed - capacity : next;
      std::uint64_t element = 0;
      CHECK(ring.try_pop(element) == (expected < pushed));
      if (expected == pushed) continue;
      CHECK(element == expected);
      next = expected + 1;
      ++got;
    }
    CHECK(ring.counters().got == got);
    CHECK(ring.counters().got + ring.counters().lost == next);
  }

  TEST_CASE("two threads: no element is torn, and got + lost = pushed") {
    constexpr std::uint64_t rounds = 300'000;
    struct Element {
      std::uint64_t number = 0;
      std::uint64_t copies[7] = {};
    };
    OverwritingRing<Element> ring(16);
    std::atomic<bool> done{false};
    std::thread producer([&] {
      Element element;
      for (; element.number < rounds; ++element.number) {
        for (auto& copy : element.copies)
          copy = ~element.number;
        ring.push(element);
        if (element.number % 2048 == 0) std::this_thread::yield(); // let it be caught up with, too
      }
      done = true;
    });
    std::uint64_t got = 0;
    bool whole = true;
    bool placed = true;
    const auto take = [&](const Element& element) {
      for (const auto copy : element.copies)
        whole = whole && copy == ~element.number;
      const auto counters = ring.counters();
      placed = placed && element.number + 1 == counters.got + counters.lost;
      ++got;
    };
    while (!done)
      ring.drain(take);
    producer.join();
    while (ring.drain(take) > 0) {
    }
    CHECK(whole);
    CHECK(placed);
    const auto counters = ring.counters();
    CHECK(counters.pushed == rounds);
    CHECK(counters.got == got);
    CHECK(counters.got + counters.lost == rounds);
  }
}

} // namespace overwriting_ring_test
