#pragma once
// Runs two threads, each on a processor of its own, and measures how long a cache line takes from
// one to the other and back. On a virtual machine that time changes during a run, so it is measured
// beside everything that depends on it.

#include <atomic>
#include <cstdint>
#include <functional>

#include <nendo/base/atomics.hpp>

#include "cli/processors.hpp"

namespace nendo::bench {

/// Runs both functions at the same time, each on its processor, and returns when both are done.
void run_on(const cli::TwoProcessors& processors, const std::function<void()>& on_first,
            const std::function<void()>& on_second);

/// Takes the oldest element of a ring. Pauses for some 0.3 microseconds if there is none, so that a
/// consumer that asks again at once does not take the producer's cache line away from it.
template <class Ring, class Element>
bool try_pop_or_pause(Ring& ring, Element& element) noexcept {
  if (ring.try_pop(element)) return true;
  for (int n = 0; n < 16; ++n)
    relax();
  return false;
}

/// One cache line that goes to and fro.
class PingPong {
public:
  /// One side. It must be called as often as the other side calls measure_ns().
  void answer() noexcept;
  /// The other side. Returns the median time of a round trip.
  double measure_ns();

private:
  alignas(2 * cache_line_bytes) std::atomic<std::uint64_t> ball_{0};
  alignas(2 * cache_line_bytes) std::uint64_t answered_ = 0;
  alignas(2 * cache_line_bytes) std::uint64_t measured_ = 0;
};

} // namespace nendo::bench
