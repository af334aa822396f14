// The whole tick under the kernel's own eyes: after warm-up the loop's thread makes no system call
// but its sleep, no allocation, and touches no page for the first time.

#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <thread>

#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <nendo/flow/realtime.hpp>
#include <nendo/recording/take_tools.hpp>

#include "support/any_puppet.hpp"
#include "support/late_maker.hpp"
#include "support/polling_viewer.hpp"
#include "support/restraint.hpp"
#include "support/sleep_only.hpp"
#include "support/takes.hpp"

namespace sleep_only_test {

using namespace nendo;
using namespace nendo::flow;
using nendo::test::LoopUnderTest;

namespace {

struct Watched {
  bool filtered = false; ///< the kernel has seccomp
  test::StoppedCalls calls;
  test::RestraintCounts counts;
  long page_faults = 0;
};

long faults_so_far() noexcept {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

/// As --mlockall does: a machine that is short of memory takes pages, also of code, from any
/// process that leaves them alone for a while. Where that is not permitted, it may do so.
struct LockedPages {
  LockedPages() { ::mlockall(MCL_CURRENT); }
  ~LockedPages() { ::munlockall(); }
  LockedPages(const LockedPages&) = delete;
  LockedPages& operator=(const LockedPages&) = delete;
};

/// Runs `warm_up`, and then `watched` on the same thread, where it may only sleep.
Watched watch(const std::function<void()>& warm_up, const std::function<void()>& watched) {
  Watched seen;
  std::thread([&] {
    make_thread_realtime({});
    warm_up();
    faults_so_far();
    seen.filtered = test::allow_sleep_only();
    {
      const test::Restraint restraint;
      const long before = faults_so_far();
      watched();
      seen.page_faults = faults_so_far() - before;
      seen.counts = restraint.counts();
      seen.calls = test::stopped_calls();
    }
    if (seen.filtered) test::end_thread();
  }).join();
  return seen;
}

/// The wrists go into the model and out of it again within 500 ticks, elsewhere each time, and the
/// model is as at first then.
void press(LoopUnderTest& test, std::uint64_t tick) {
  const double turn = 2.0 * std::numbers::pi * static_cast<double>(tick) / 500.0;
  for (const Side side : {Side::left, Side::right}) {
    Eigen::Isometry3d wrist = test.placement.T_stage_wrist[flow::Placement::index_of(side)];
    const double inwards = side == Side::left ? 0.03 : -0.03;
    wrist.pretranslate(Eigen::Vector3d(inwards * std::sin(turn), 0.04 * std::sin(0.13 * turn),
                                       0.04 * std::sin(0.07 * turn)));
    test.commands.try_push(flow::WristMove::to(side, wrist));
  }
  if (tick % 500 == 0) test.commands.try_push(flow::Request::reset);
}

/// Both gloves open and close a hand within 60 ticks.
void move_and_tick(LoopUnderTest& test, std::uint64_t first, std::uint64_t ticks) {
  const HostTime begin = HostClock::now();
  for (std::uint64_t tick = first; tick < first + ticks; ++tick) {
    const int bent = static_cast<int>(tick % 60);
    test.bend(bent < 30 ? bent : 60 - bent, begin + tick * std::chrono::milliseconds(1));
    if (test.options.sculptor.mode == Mode::clay) press(test, tick);
    test.loop->tick(tick, HostClock::now()); // its frames are the viewer's to take
  }
}

/// Asks for everything that a run can be asked for, at random, on a thread of its own, as who runs
/// a loop does.
class Asker {
public:
  explicit Asker(LoopUnderTest& test) : test_(test), thread_([this] { ask(); }) {}
  ~Asker() { end(); }
  Asker(const Asker&) = delete;
  Asker& operator=(const Asker&) = delete;

  void end() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }
  int settings() const noexcept { return settings_; } ///< once it has ended, as these
  int masks() const noexcept { return masks_; }
  int models() const noexcept { return maker_.made(); }

private:
  void ask() {
    DeformLoop& loop = *test_.loop;
    while (!over_) {
      std::this_thread::sleep_for(std::chrono::microseconds(300));
      loop.changes().refill_undo();
      if (loop.frames().update() && loop.frames().front().awaited)
        static_cast<void>(loop.changes().change_to(*loop.frames().front().awaited));
      maker_.turn(loop);
      test_.commands.try_push(any_command());
      if (random_() % 4 == 0 &&
          loop.changes().change_settings(test::any_settings(loop.changes().settings(), random_)))
        ++settings_;
      if (random_() % 4 != 0) continue;
      const auto masks =
          test::any_masks(loop.changes().puppet(loop.changes().newest_puppet()), random_);
      if (masks && loop.changes().change_puppet(masks)) ++masks_;
    }
  }
  Command any_command() {
    switch (random_() % 5) {
    case 0:
      return Mark{};
    case 1:
      return SetLayer{0, random_() % 2 == 0};
    case 2:
      return test::any_role(random_); // of a puppet that is not there
    case 3:
      return WristMove::to(Side::left, test_.placement.T_stage_wrist[0]);
    default:
      return requests[random_() % requests.size()];
    }
  }

  LoopUnderTest& test_;
  std::mt19937 random_{7};
  test::LateMaker maker_{8, 1000};
  int settings_ = 0, masks_ = 0;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

} // namespace

// The sanitizers' own run-time makes calls and allocates.
TEST_SUITE("sleep_only" * doctest::skip(!nendo::test::restraint_is_counted)) {
  TEST_CASE("a system call, an allocation and a fresh page are each seen, or nothing is proved") {
    constexpr std::size_t page = 4096;
    void* const memory =
        ::mmap(nullptr, page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    REQUIRE(memory != MAP_FAILED);
    long answer = 0;
    const Watched seen = watch([] {},
                               [&] {
                                 answer = ::syscall(SYS_getppid);
                                 auto* volatile number = new std::uint64_t(7); // not optimised away
                                 delete number;
                                 *static_cast<volatile char*>(memory) = 1;
                               });
    ::munmap(memory, page);
    REQUIRE(seen.filtered);
    CHECK(seen.calls.count == 1);
    CHECK(seen.calls.last == SYS_getppid);
    CHECK(answer == -1); // and was not done
    CHECK(seen.counts.allocations == 1);
    CHECK(seen.counts.frees == 1);
    CHECK(seen.page_faults == 1);
  }

  TEST_CASE("100,000 ticks of two hands, in each mode, with a viewer and a recorder attached: no "
            "call, no allocation, no page fault") {
    for (const Mode mode : {Mode::type1, Mode::type2, Mode::clay}) {
      CAPTURE(name_of(mode));
      test::RecordedLoop recorded(mode);
      recorded.record();
      LoopUnderTest& test = recorded.test;
      test::PollingViewer viewer(test);
      std::optional<LockedPages> locked;
      const Watched seen = watch(
          [&] {
            move_and_tick(test, 0, 300);
            locked.emplace();
          },
          [&] { move_and_tick(test, 300, 100'000); });
      CHECK(viewer.end() > 1);
      REQUIRE(seen.filtered);
      CHECK(seen.calls.count == 0);
      CHECK(seen.calls.last == -1);
      CHECK(seen.counts.allocations == 0);
      CHECK(seen.counts.frees == 0);
      CHECK(seen.counts.locks == 0);
      CHECK(seen.page_faults == 0);
      CHECK(test.loop->stats().ticks == 100'300);
      CHECK(test.loop->stats().failed == 0);
      CHECK((test.loop->stats().touching_ticks > 10'000) == (mode == Mode::clay));
      CHECK(test.loop->stats().samples[1] == 100'300);
      const auto taken = recorded.end(); // faster than a disk perhaps, but all is accounted for
      REQUIRE(taken);
      CHECK(taken->ticks > 0);
      // Clay has two moved wrists a tick, and 201 resets.
      const std::uint64_t offered = mode == Mode::clay ? 5 * 100'300 + 201 : 3 * 100'300;
      const auto summary = recording::summarise(recorded.path);
      REQUIRE(summary);
      CHECK(taken->ticks + taken->samples + taken->requests + summary->wrist_moves + taken->lost ==
            offered);
    }
  }

  TEST_CASE("100,000 ticks with commands of all kinds at random, masks and symmetry among them: no "
            "call, no allocation, no lock") {
    LoopUnderTest test(Mode::type1, {.rings_of_ball = 8});
    std::optional<Asker> asker;
    const Watched seen = watch(
        [&] {
          move_and_tick(test, 0, 300);
          asker.emplace(test);
        },
        [&] { move_and_tick(test, 300, 100'000); });
    asker->end();
    REQUIRE(seen.filtered);
    CHECK(seen.calls.count == 0);
    CHECK(seen.calls.last == -1);
    CHECK(seen.counts.allocations == 0);
    CHECK(seen.counts.frees == 0);
    CHECK(seen.counts.locks == 0);
    CHECK(test.loop->stats().ticks == 100'300);
    CHECK(asker->settings() > 100);
    CHECK(asker->masks() > 100);
    CHECK(asker->models() > 0);
    CHECK(test.loop->stats().undos > 10);
  }

  TEST_CASE("waiting for the next tick is the sleep and nothing else, whatever the policy") {
    for (const auto policy :
         {OverrunPolicy::skip, OverrunPolicy::catch_up, OverrunPolicy::re_anchor}) {
      for (const bool spin : {false, true}) {
        TickRing records(4096);
        PaceOptions options;
        options.rate_hz = 10'000.0;
        options.policy = policy;
        options.spin = spin;
        const auto run = [&] {
          Pacer pacer(options, HostClock::now());
          while (pacer.next() < 2000) {
            const Pacer::Due due = pacer.wait();
            records.try_push({.tick = due.number, .scheduled = due.scheduled, .woke = due.woke});
            pacer.end_tick(HostClock::now());
          }
        };
        const Watched seen = watch(run, run); // once before, so that no page of its code is new
        REQUIRE(seen.filtered);
        CHECK(seen.calls.count == 0);
        CHECK(seen.counts.allocations + seen.counts.frees + seen.counts.locks == 0);
        CHECK(seen.page_faults == 0);
        CHECK(records.size() > 0);
      }
    }
  }
}

} // namespace sleep_only_test
