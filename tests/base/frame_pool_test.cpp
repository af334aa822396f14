#include <nendo/base/frame_pool.hpp>

#include <atomic>
#include <cstdint>
#include <deque>
#include <random>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace frame_pool_test {

using nendo::FramePool;

TEST_SUITE("frame_pool") {
  TEST_CASE("every frame has the size of the initial one") {
    FramePool<std::vector<int>> pool(3, std::vector<int>(7));
    for (int n = 0; n < 3; ++n) {
      auto* frame = pool.claim();
      REQUIRE(frame != nullptr);
      CHECK(frame->size() == 7);
      pool.publish();
    }
  }

  TEST_CASE("a claimed frame stays the same until it is published") {
    FramePool<int> pool(2, 0);
    int* first = pool.claim();
    CHECK(pool.claim() == first);
    pool.publish();
    CHECK(pool.claim() != first);
  }

  TEST_CASE("a frame is handed over where it is, not copied") {
    FramePool<int> pool(2, 0);
    const int* written = pool.claim();
    pool.publish();
    CHECK(pool.take() == written);
  }

  TEST_CASE("when all frames are under way the newest is dropped and counted") {
    FramePool<int> pool(3, 0);
    for (int n = 0; n < 5; ++n) {
      if (int* frame = pool.claim()) {
        *frame = n;
        pool.publish();
      }
    }
    const auto counters = pool.counters();
    CHECK(counters.offered == 5);
    CHECK(counters.dropped == 2);
    CHECK(counters.high_water == 3);
    for (int n = 0; n < 3; ++n) {
      const int* frame = pool.take();
      REQUIRE(frame != nullptr);
      CHECK(*frame == n);
      pool.give_back(frame);
    }
    CHECK(pool.take() == nullptr);
    CHECK(pool.claim() != nullptr);
  }

  TEST_CASE(
      "it behaves like a queue of at most so many frames, whatever the order of giving back") {
    std::mt19937 random(5);
    FramePool<std::uint32_t> pool(5, 0);
    std::deque<std::uint32_t> waiting;
    std::deque<std::pair<const std::uint32_t*, std::uint32_t>> held;
    std::uint64_t dropped = 0;
    for (std::uint32_t n = 0; n < 20'000; ++n) {
      const auto action = random() % 5;
      if (action < 2) {
        auto* frame = pool.claim();
        CHECK((frame != nullptr) == (waiting.size() + held.size() < 5));
        if (frame == nullptr) {
          ++dropped;
        } else {
          *frame = n;
          pool.publish();
          waiting.push_back(n);
        }
      } else if (action == 2) {
        const auto* frame = pool.take();
        CHECK((frame != nullptr) == !waiting.empty());
        if (frame == nullptr) continue;
        CHECK(*frame == waiting.front());
        held.emplace_back(frame, waiting.front());
        waiting.pop_front();
      } else if (!held.empty()) {
        const auto at = held.begin() + static_cast<std::ptrdiff_t>(random() % held.size());
        CHECK(*at->first == at->second); // nobody wrote to it meanwhile
        pool.give_back(at->first);
        held.erase(at);
      }
    }
    const auto counters = pool.counters();
    CHECK(counters.dropped == dropped);
    CHECK(counters.offered == counters.taken + counters.dropped + waiting.size());
  }

  TEST_CASE("two threads: frames are whole, in order, and offered = taken + dropped") {
    constexpr std::uint64_t rounds = 100'000;
    struct Frame {
      std::uint64_t number = 0;
      std::uint64_t copies[16] = {};
    };
    FramePool<Frame> pool(8, Frame{});
    std::atomic<bool> done{false};
    std::thread writer([&] {
      for (std::uint64_t n = 1; n <= rounds; ++n) {
        if (Frame* frame = pool.claim()) {
          frame->number = n;
          for (auto& copy : frame->copies)
            copy = n;
          pool.publish();
        }
        if (n % 1024 == 0) std::this_thread::yield(); // one core must not starve the reader
      }
      done = true;
    });
    std::uint64_t last = 0;
    std::uint64_t taken = 0;
    bool whole = true;
    bool forward = true;
    for (bool more = true; more;) {
      more = !done;
      while (const Frame* frame = pool.take()) {
        for (const auto copy : frame->copies)
          whole = whole && copy == frame->number;
        forward = forward && frame->number > last;
        last = frame->number;
        ++taken;
        pool.give_back(frame);
      }
    }
    writer.join();
    CHECK(whole);
    CHECK(forward);
    CHECK(taken > 0);
    const auto counters = pool.counters();
    CHECK(counters.offered == rounds);
    CHECK(counters.taken == taken);
    CHECK(counters.offered == counters.taken + counters.dropped);
  }
}

} // namespace frame_pool_test
