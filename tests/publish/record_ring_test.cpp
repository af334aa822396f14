#include <array>
#include <memory>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "publish/frame_record.hpp"
#include "support/parked.hpp"

namespace record_ring_test {

using namespace nendo::publish;

namespace {

constexpr std::size_t slots = 4;
constexpr std::size_t words = 50;

/// Every word of a record has its number, and none that of its neighbour.
std::uint64_t word_of(std::uint64_t number, std::size_t at) noexcept {
  return number * 0x9E3779B97F4A7C15U + at;
}

struct Ring {
  std::unique_ptr<AtomicWord[]> memory = std::make_unique<AtomicWord[]>(slots * (words + 1));
  RecordRing ring{memory.get(), slots, words + 1};
  std::atomic<std::uint64_t> newest{0};

  void write_next() noexcept {
    const std::uint64_t number = newest.load(std::memory_order_relaxed) + 1;
    std::array<std::uint64_t, words> record{};
    for (std::size_t at = 0; at < words; ++at)
      record[at] = word_of(number, at);
    ring.write(number, record);
    newest.store(number, std::memory_order_relaxed);
  }
  /// Whether there was a record; `whole` becomes false if it was torn, or another one.
  bool look(bool& whole) const noexcept {
    const std::uint64_t number = newest.load(std::memory_order_relaxed);
    std::array<std::uint64_t, words> record{};
    if (number == 0 || !ring.read(number, record)) return false;
    for (std::size_t at = 0; at < words; ++at)
      whole = whole && record[at] == word_of(number, at);
    return true;
  }
};

} // namespace

TEST_SUITE("record_ring") {
  TEST_CASE("the newest records are there, older and later ones are not") {
    Ring test;
    std::array<std::uint64_t, words> record{};
    CHECK_FALSE(test.ring.read(1, record));
    for (int n = 0; n < 11; ++n)
      test.write_next();
    for (std::uint64_t number = 1; number <= 16; ++number) {
      const bool there = number > 11 - slots && number <= 11;
      CHECK(test.ring.read(number, record) == there);
      if (there) CHECK(record[7] == word_of(number, 7));
    }
  }

  TEST_CASE("a writer at full speed, and three readers: nothing that counts as read is torn") {
    Ring test;
    std::atomic<bool> done{false};
    std::array<std::uint64_t, 3> read{};
    std::array<bool, 3> whole{true, true, true};
    std::vector<std::thread> readers;
    for (std::size_t reader = 0; reader < read.size(); ++reader) {
      readers.emplace_back([&, reader] {
        // Each has looked a thousand times at least, however the machine is loaded.
        while (!done || read[reader] < 1000)
          read[reader] += test.look(whole[reader]) ? 1U : 0U;
      });
    }
    for (int n = 0; n < 300'000; ++n) {
      test.write_next();
      if (n % 1024 == 0) std::this_thread::yield();
    }
    done = true;
    for (auto& reader : readers)
      reader.join();
    for (std::size_t reader = 0; reader < read.size(); ++reader) {
      CHECK(whole[reader]);
      CHECK(read[reader] >= 1000);
    }
    CHECK(test.newest == 300'000);
  }

  TEST_CASE("the writer continues wherever a reader stops") {
    Ring test;
    test.write_next();
    bool whole = true;
    nendo::test::ParkedPeer reader([&] { test.look(whole); });
    for (int round = 0; round < 100; ++round) {
      reader.park();
      const std::uint64_t before = test.newest;
      for (int n = 0; n < 50; ++n)
        test.write_next();
      CHECK(test.newest == before + 50);
      reader.resume();
    }
  }
}

} // namespace record_ring_test
