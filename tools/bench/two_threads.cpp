#include "bench/two_threads.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <sched.h>
#include <thread>

namespace nendo::bench {
namespace {

constexpr std::size_t blocks = 21;
constexpr std::uint64_t trips_a_block = 100;

void stay_on(int processor) noexcept {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(static_cast<std::size_t>(processor), &only);
  sched_setaffinity(0, sizeof only, &only); // allowed a moment ago; if not any more, still correct
}

} // namespace

void run_on(const cli::TwoProcessors& processors, const std::function<void()>& on_first,
            const std::function<void()>& on_second) {
  std::thread first([&] {
    stay_on(processors.first);
    on_first();
  });
  std::thread second([&] {
    stay_on(processors.second);
    on_second();
  });
  first.join();
  second.join();
}

void PingPong::answer() noexcept {
  for (std::uint64_t n = 0; n < blocks * trips_a_block; ++n, answered_ += 2) {
    while (ball_.load(std::memory_order_acquire) != answered_ + 1) {
    }
    ball_.store(answered_ + 2, std::memory_order_release);
  }
}

double PingPong::measure_ns() {
  std::array<double, blocks> trips_ns{};
  for (double& trip_ns : trips_ns) {
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint64_t n = 0; n < trips_a_block; ++n) {
      ball_.store(++measured_, std::memory_order_release);
      ++measured_;
      while (ball_.load(std::memory_order_acquire) != measured_) {
      }
    }
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    trip_ns = took.count() / static_cast<double>(trips_a_block);
  }
  std::nth_element(trips_ns.begin(), trips_ns.begin() + blocks / 2, trips_ns.end());
  return trips_ns[blocks / 2];
}

} // namespace nendo::bench
