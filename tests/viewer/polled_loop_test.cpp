// A window that shows the loop does not disturb it.

#include <atomic>

#include <doctest/doctest.h>

#include "support/polling_viewer.hpp"
#include "support/restraint.hpp"

namespace polled_loop_test {

using namespace nendo;
using nendo::test::LoopUnderTest;
using nendo::test::PollingViewer;
using nendo::test::Restraint;

TEST_SUITE("polled_loop") {
  TEST_CASE(
      "with a viewer that polls at 1 kHz and builds scenes, the loop allocates, frees and locks "
      "nothing, and misses no frame of its own") {
    for (const auto mode : {flow::Mode::type1, flow::Mode::type2}) {
      LoopUnderTest test(mode);
      PollingViewer viewer(test);
      test::RestraintCounts counts;
      const std::atomic<bool> never{false};
      {
        const Restraint restraint;
        for (int stretch = 0; stretch < 30; ++stretch) {
          test.bend(stretch % 2 == 0 ? 20 : 4, HostClock::now());
          test.loop->run(never, 20);
        }
        counts = restraint.counts();
      }
      const std::uint64_t scenes = viewer.end();
      CHECK(counts.allocations == 0);
      CHECK(counts.frees == 0);
      CHECK(counts.locks == 0);
      const auto& stats = test.loop->stats();
      CHECK(stats.ticks + stats.missed == 600);
      CHECK(stats.failed == 0);
      CHECK(scenes > 1);
    }
  }
}

} // namespace polled_loop_test
