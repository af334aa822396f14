// Lock-free means: if one thread is stopped anywhere, the other one continues. Here it is stopped
// 300 times at instructions that chance picks. The control is a queue behind a mutex, which must
// fail.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <utility>

#include <doctest/doctest.h>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/triple_buffer.hpp>

#include "support/parked.hpp"

namespace parked_test {

namespace {

constexpr int parkings = 300;
constexpr int operations = 100; ///< in each parking

/// While the peer is stopped, `operation` must say each time that it got on with its work.
/// Returns how often it did not.
template <class Operation>
int stalls(std::function<void()> peers_work, Operation operation) {
  nendo::test::ParkedPeer peer(std::move(peers_work));
  int stalled = 0;
  for (int n = 0; n < parkings; ++n) {
    peer.park();
    for (int k = 0; k < operations; ++k)
      stalled += operation() ? 0 : 1;
    peer.resume();
  }
  return stalled;
}

using Block = std::array<std::uint64_t, 64>; ///< long enough to be stopped in

} // namespace

TEST_SUITE("parked") {
  TEST_CASE("the control: a mutex makes one side wait for the other") {
    std::mutex mutex;
    std::deque<Block> queue;
    const auto peer = [&] {
      const std::lock_guard lock(mutex);
      if (!queue.empty()) queue.pop_front();
      queue.push_back(Block{});
    };
    CHECK(stalls(peer, [&] {
            const std::unique_lock lock(mutex, std::try_to_lock);
            return lock.owns_lock();
          }) > 0);
  }

  TEST_CASE("a producer continues beside a stopped consumer, until the ring is full") {
    nendo::SpscRing<Block> ring(16);
    std::uint64_t offered = 0;
    std::uint64_t taken = 0;
    const auto drain = [&] { taken += ring.drain([](const Block&) {}); };
    CHECK(stalls(drain, [&] {
            ++offered;
            const bool full = ring.size() == ring.capacity();
            return ring.try_push(Block{}) != full;
          }) == 0);
    drain();
    CHECK(ring.counters().offered == offered);
    CHECK(ring.counters().consumed == taken);
    CHECK(offered == taken + ring.counters().refused);
  }

  TEST_CASE("a consumer continues beside a stopped producer, until the ring is empty") {
    nendo::SpscRing<Block> ring(16);
    std::uint64_t taken = 0;
    CHECK(stalls([&] { ring.try_push(Block{}); },
                 [&] {
                   const bool empty = ring.size() == 0;
                   Block block;
                   const bool got = ring.try_pop(block);
                   taken += got ? 1U : 0U;
                   return got != empty;
                 }) == 0);
    CHECK(taken > 0);
    CHECK(ring.counters().offered == taken + ring.counters().refused + ring.size());
  }

  TEST_CASE("a writer publishes beside a stopped reader, and the other way round") {
    nendo::TripleBuffer<Block> value(Block{});
    std::uint64_t number = 0;
    std::uint64_t seen = 0;
    bool forward = true;
    const auto publish = [&] {
      value.back().fill(++number);
      value.publish();
      return true;
    };
    const auto read = [&] {
      value.update();
      const Block& now = value.front();
      forward = forward && now[0] >= seen && now[0] == now[63];
      seen = now[0];
      return forward;
    };
    CHECK(stalls(read, publish) == 0);
    CHECK(stalls(publish, read) == 0);
    read();
    CHECK(seen == number);
  }
}

} // namespace parked_test
