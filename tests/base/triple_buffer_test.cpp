#include <nendo/base/triple_buffer.hpp>

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace triple_buffer_test {

using nendo::TripleBuffer;

TEST_SUITE("triple_buffer") {
  TEST_CASE("a reader gets the newest value once, then learns that there is none") {
    TripleBuffer<int> value(0);
    CHECK_FALSE(value.update());
    value.back() = 1;
    CHECK_FALSE(value.publish());
    value.back() = 2;
    CHECK(value.publish());
    REQUIRE(value.update());
    CHECK(value.front() == 2);
    CHECK_FALSE(value.update());
    CHECK(value.front() == 2);
  }

  TEST_CASE("the buffers have the size of the initial value") {
    TripleBuffer<std::vector<int>> value(std::vector<int>(7));
    for (int i = 0; i < 4; ++i) {
      CHECK(value.back().size() == 7);
      value.publish();
      CHECK(value.update());
      CHECK(value.front().size() == 7);
    }
  }

  TEST_CASE("two threads: values are never torn and never go back") {
    constexpr std::uint64_t rounds = 200'000;
    struct Frame {
      std::uint64_t number = 0;
      std::uint64_t copies[16] = {};
    };
    TripleBuffer<Frame> value(Frame{});
    std::atomic<std::uint64_t> overwritten{0};
    std::thread writer([&] {
      std::uint64_t lost = 0;
      for (std::uint64_t n = 1; n <= rounds; ++n) {
        value.back().number = n;
        for (auto& copy : value.back().copies)
          copy = n;
        if (value.publish()) ++lost;
      }
      overwritten = lost;
    });
    std::uint64_t last = 0;
    std::uint64_t seen = 0;
    bool whole = true;
    bool forward = true;
    while (last < rounds) {
      if (!value.update()) continue;
      const Frame& frame = value.front();
      for (const auto copy : frame.copies)
        whole = whole && copy == frame.number;
      forward = forward && frame.number > last;
      last = frame.number;
      ++seen;
    }
    writer.join();
    CHECK(whole);
    CHECK(forward);
    CHECK(seen + overwritten == rounds);
  }
}

} // namespace triple_buffer_test
