// A tick that publishes is a tick like any other: no allocation, no lock, no system call, no page
// that was not there; whatever its readers do.

#include <thread>

#include <sys/resource.h>

#include "publish/osc_publisher.hpp"
#include "publish/publish_fixtures.hpp"
#include "publish/segment.hpp"
#include "publish/vrpn_publisher.hpp"
#include "support/restraint.hpp"
#include "support/sleep_only.hpp"

namespace tick_test {

using namespace nendo;
using namespace nendo::publish;
using test::LoopUnderTest;

namespace {

OscTarget port_9() {
  OscTarget target;
  target.endpoint.port = 9;
  return target;
}

long faults_so_far() noexcept {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

void move_and_tick(LoopUnderTest& test, std::uint64_t first, std::uint64_t ticks) {
  const HostTime begin = HostClock::now();
  for (std::uint64_t tick = first; tick < first + ticks; ++tick) {
    const int bent = static_cast<int>(tick % 60);
    test.bend(bent < 30 ? bent : 60 - bent, begin + tick * std::chrono::milliseconds(1));
    test.loop->tick(tick, HostClock::now());
  }
}

} // namespace

TEST_SUITE("publishing_tick") {
  TEST_CASE("with a segment, its reader, datagrams and a server attached no tick allocates, frees, "
            "locks or "
            "calls the system, and none meets a new page") {
    if (!test::restraint_is_counted) return;
    for (const auto mode : {flow::Mode::type1, flow::Mode::type2}) {
      LoopUnderTest test(mode, {.rings_of_ball = 16});
      SegmentPublisher publisher(test::segment_name("tick"), {});
      OscPublisher sender("osc:9", port_9());
      VrpnPublisher server("vrpn", VrpnTarget{});
      test::attach(test, {&publisher, &sender, &server});
      REQUIRE(publisher.begin(test::outline_of(test)));
      REQUIRE(sender.begin(test::outline_of(test)));
      REQUIRE(server.begin(test::outline_of(test)));
      const test::MappedSegment segment(test::segment_name("tick"));
      std::atomic<bool> over{false};
      std::uint64_t read = 0;
      std::thread reader([&] {
        nendo_publish_record record{};
        while (!over || read == 0)
          read +=
              nendo_publish_read(segment.base(), segment.newest(), &record, nullptr, 0) ? 1U : 0U;
      });
      bool filtered = false;
      long page_faults = 0;
      test::StoppedCalls calls;
      test::RestraintCounts counts;
      std::thread([&] {
        move_and_tick(test, 0, 600); // a round of every slot
        faults_so_far();
        filtered = test::allow_sleep_only();
        {
          const test::Restraint restraint;
          const long before = faults_so_far();
          move_and_tick(test, 600, 5000);
          page_faults = faults_so_far() - before;
          counts = restraint.counts();
          calls = test::stopped_calls();
        }
        if (filtered) test::end_thread();
      }).join();
      over = true;
      reader.join();
      sender.end();
      server.end();
      REQUIRE(filtered);
      CHECK(calls.count == 0);
      CHECK(counts.allocations + counts.frees + counts.locks == 0);
      CHECK(page_faults == 0);
      CHECK(read > 0);
      CHECK(segment.newest() == 5600);
      CHECK(sender.counts().records == 5600);
      CHECK(sender.counts().sent + sender.counts().lost == 5600);
      CHECK(server.counts().sent + server.counts().lost == 5600);
      CHECK(test.loop->stats().failed == 0);
    }
  }
}

} // namespace tick_test
