// The loop is sacred: after start-up its thread allocates nothing, frees nothing and takes no lock.

#include <chrono>
#include <mutex>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"
#include "support/restraint.hpp"
#include "support/takes.hpp"

namespace restraint_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::flow;
using nendo::test::LoopUnderTest;
using nendo::test::Restraint;

TEST_SUITE("restraint") {
  TEST_CASE("the counters count: a vector, a mutex, an aligned allocation") {
    std::mutex mutex;
    test::RestraintCounts counts;
    {
      const Restraint restraint;
      auto* vector = new std::vector<int>(100);
      delete vector;
      mutex.lock();
      mutex.unlock();
      Eigen::MatrixXd matrix(50, 50);
      matrix.setZero();
      counts = restraint.counts();
    }
    if (!test::restraint_is_counted) return;
    CHECK(counts.allocations == 3);
    CHECK(counts.frees == 2); // the matrix is still there
    CHECK(counts.locks == 1);
  }

  TEST_CASE("no tick allocates, frees or locks, in either mode, with two hands in motion") {
    using hand::FilterKind;
    for (const auto& [of_model, of_hands] : {std::pair{Mode::type1, FilterKind::off},
                                             {Mode::type2, FilterKind::off},
                                             {Mode::type1, FilterKind::one_euro},
                                             {Mode::type2, FilterKind::one_euro}}) {
      // With the filter, adaptation too.
      const Mode mode = of_model; // Clang 14 captures no structured bindings
      const FilterKind filter = of_hands;
      const bool adapts = filter != FilterKind::off;
      LoopUnderTest test(
          mode, {.filter = filter, .adapt = adapts ? std::optional(CountScale{}) : std::nullopt});
      test::RestraintCounts counts;
      const HostTime begin = HostClock::now();
      // Samples are pushed, and frames read, on this thread too: the ring and the exchange are held
      // to the same rule.
      {
        const Restraint restraint;
        for (std::uint64_t tick = 0; tick < 600; ++tick) {
          const int counts_bent = static_cast<int>(tick % 60);
          // At a glove's own pace, by their times: a filter would not let a faster hand through.
          test.bend(counts_bent < 30 ? counts_bent : 60 - counts_bent, begin + tick * 11ms);
          test.frame_after_tick(tick);
        }
        counts = restraint.counts();
      }
      CAPTURE(name_of(mode));
      CAPTURE(name_of(filter));
      CHECK(counts.allocations == 0);
      CHECK(counts.frees == 0);
      CHECK(counts.locks == 0);
      CHECK(test.loop->stats().ticks == 600);
      CHECK(test.loop->stats().failed == 0);
      constexpr auto index_mcp = static_cast<std::size_t>(Sensor::index_mcp);
      CHECK((test.loop->stats().ranges[0][index_mcp].turns > 0) == adapts);
      CHECK((test.loop->stats().filter_moving.count() > 0) == (filter != FilterKind::off));
      CHECK((test.vertices_of(test.loop->frames().front()) - test.model.vertices)
                .cwiseAbs()
                .maxCoeff() > 1e-3);
    }
  }

  TEST_CASE("with a recorder attached, and requests, no tick does either, and nothing is lost") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      test::RecordedLoop recorded(mode, hand::FilterKind::one_euro, true, true);
      recorded.record();
      test::RestraintCounts counts;
      {
        const Restraint restraint;
        test::play(recorded, 400);
        counts = restraint.counts();
      }
      CHECK(counts.allocations == 0);
      CHECK(counts.frees == 0);
      CHECK(counts.locks == 0);
      const auto taken = recorded.end();
      REQUIRE(taken);
      CHECK(taken->ticks == 400);
      CHECK(taken->requests > 0);
      CHECK(taken->lost == 0);
    }
  }

  TEST_CASE("running at the fixed rate, sleeping included, does not either") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode, {.rate_hz = 2000.0});
      std::atomic<bool> stop{false};
      test.bend(12, HostClock::now());
      test::RestraintCounts counts;
      {
        const Restraint restraint;
        test.loop->run(stop, 300);
        counts = restraint.counts();
      }
      CHECK(counts.allocations + counts.frees + counts.locks == 0);
    }
  }
}

} // namespace restraint_test
