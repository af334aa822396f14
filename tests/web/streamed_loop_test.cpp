// A loop with a FrameStream keeps its promises for the tick while shapes are requested over and
// over.

#include <atomic>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/flow/realtime.hpp>

#include "streamed_loop.hpp"
#include "support/restraint.hpp"
#include "support/sleep_only.hpp"

namespace streamed_loop_test {

using namespace nendo;
using nendo::test::StreamedLoop;

// The sanitizers' own run-time makes calls and allocates.
TEST_SUITE("streamed_loop" * doctest::skip(!nendo::test::restraint_is_counted)) {
  TEST_CASE("with a stream that is active and asked for shapes, a tick makes no system call, no "
            "allocation and takes no lock") {
    for (const auto& way : {std::pair<flow::Mode, const char*>{flow::Mode::type1, nullptr},
                            {flow::Mode::type2, nullptr},
                            {flow::Mode::type1, test::ball_puppet}}) {
      const flow::Mode mode = way.first;
      const char* const puppet = way.second;
      CAPTURE(name_of(mode));
      CAPTURE((puppet != nullptr));
      StreamedLoop streamed(mode, {.injective = deform::InjectiveOptions{}, .puppet = puppet});
      streamed.stream->set_active(true);
      std::atomic<bool> over{false};
      std::atomic<std::uint64_t> records{0};
      std::atomic<std::uint64_t> shapes{0};
      std::thread server([&] {
        while (!over) {
          std::vector<web::Record> taken;
          streamed.stream->take(taken);
          records += taken.size();
          if (streamed.stream->take_shape()) ++shapes;
          streamed.stream->request_shape();
          std::this_thread::yield();
        }
      });
      bool filtered = false;
      test::StoppedCalls calls;
      test::RestraintCounts counts;
      std::thread([&] {
        flow::make_thread_realtime({});
        constexpr std::array asked{flow::Request::commit, flow::Request::undo,
                                   flow::Request::release, flow::Request::grab};
        const auto run = [&](std::uint64_t first, std::uint64_t ticks) {
          for (std::uint64_t tick = first; tick < first + ticks; ++tick) {
            const int bent = static_cast<int>(tick % 60);
            streamed.test.bend(bent < 30 ? bent : 60 - bent, HostClock::now());
            if (tick % 50 == 0) streamed.test.commands.try_push(asked[tick / 50 % asked.size()]);
            streamed.test.loop->tick(tick, HostClock::now());
          }
        };
        run(0, 300);
        filtered = test::allow_sleep_only();
        {
          const test::Restraint restraint;
          run(300, 10'000);
          counts = restraint.counts();
          calls = test::stopped_calls();
        }
        if (filtered) test::end_thread();
      }).join();
      over = true;
      server.join();
      REQUIRE(filtered);
      CHECK(calls.count == 0);
      CHECK(calls.last == -1);
      CHECK(counts.allocations == 0);
      CHECK(counts.frees == 0);
      CHECK(counts.locks == 0);
      const auto& stats = streamed.test.loop->stats();
      CHECK(stats.ticks == 10'300);
      CHECK(stats.commits > 10);
      CHECK(stats.undos > 10);
      std::vector<web::Record> rest;
      streamed.stream->take(rest);
      CHECK(records + rest.size() + streamed.stream->lost() == 10'300);
      CHECK(shapes > 0);
    }
  }
}

} // namespace streamed_loop_test
