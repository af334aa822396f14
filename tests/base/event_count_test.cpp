#include <nendo/base/event_count.hpp>

#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

namespace event_count_test {

using namespace nendo;
using namespace std::chrono_literals;

TEST_SUITE("event count") {
  TEST_CASE("what has rung is heard once, however often it rang") {
    EventCount event_count;
    CHECK_FALSE(event_count.wait(HostClock::now()));
    event_count.notify();
    event_count.notify();
    CHECK(event_count.wait(HostClock::now() + 1h));
    CHECK_FALSE(event_count.wait(HostClock::now()));
  }

  TEST_CASE("in silence it waits until the time and no shorter") {
    EventCount event_count;
    const HostTime until = HostClock::now() + 20ms;
    CHECK_FALSE(event_count.wait(until));
    CHECK(HostClock::now() >= until);
    CHECK_FALSE(event_count.wait(until - 1h));
  }

  TEST_CASE("no ring is ever slept through, from several threads, at any moment") {
    // Each message is answered before the next is sent: a single lost wake-up would stop them all.
    constexpr int messages = 20'000;
    EventCount event_count;
    std::array<std::atomic<int>, 2> sent{};
    std::array<std::atomic<int>, 2> answered{};
    std::vector<std::thread> senders;
    for (std::size_t k = 0; k < sent.size(); ++k) {
      senders.emplace_back([&, k] {
        for (int n = 1; n <= messages; ++n) {
          sent[k].store(n, std::memory_order_relaxed);
          event_count.notify();
          while (answered[k].load(std::memory_order_relaxed) != n)
            std::this_thread::yield();
        }
      });
    }
    const HostTime end = HostClock::now() + 100s;
    int slept_through = 0;
    while (answered[0] + answered[1] < 2 * messages && slept_through == 0) {
      if (!event_count.wait(end)) ++slept_through;
      for (std::size_t k = 0; k < sent.size(); ++k)
        answered[k].store(sent[k].load(std::memory_order_relaxed), std::memory_order_relaxed);
    }
    CHECK(slept_through == 0);
    if (slept_through == 0) CHECK(answered[0] + answered[1] == 2 * messages);
    for (std::size_t k = 0; k < sent.size() && slept_through > 0; ++k)
      answered[k] = messages;
    for (auto& sender : senders)
      sender.join();
  }
}

} // namespace event_count_test
