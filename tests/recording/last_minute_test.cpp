#include "last_minute.hpp"

#include <csignal>
#include <cstdlib>
#include <thread>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/eventually.hpp"
#include "support/takes.hpp"

namespace last_minute_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::recording;
using flow::Mode;
using test::RecordedLoop;

namespace {

/// To do to a ring what a crash may have done to it. An explicit instantiation may name what is
/// private.
std::vector<std::byte>& memory_of(LastMinute& ring);
template <std::vector<std::byte> LastMinute::* memory>
struct Reach {
  friend std::vector<std::byte>& memory_of(LastMinute& ring) { return ring.*memory; }
};
template struct Reach<&LastMinute::memory_>;

struct Kept {
  std::vector<std::uint64_t> ticks;
  std::uint64_t missing = 0;
  std::uint64_t gaps = 0;
  std::uint64_t damages = 0;
};

Kept read(const std::filesystem::path& path) {
  auto reader = TakeReader::open(path);
  REQUIRE(reader);
  CHECK(reader->setup().hands.size() == 2);
  CHECK(reader->setup().loop.has_value());
  Kept kept;
  while (const auto entry = reader->next()) {
    if (const auto* tick = std::get_if<flow::LoggedTick>(&*entry))
      kept.ticks.push_back(tick->number);
    if (const auto* gap = std::get_if<Gap>(&*entry)) {
      ++kept.gaps;
      kept.missing += gap->entries;
    }
  }
  kept.damages = reader->chunks().damage_count() + reader->unknown_entries();
  return kept;
}

/// A ring filled with ticks, some per payload, a second apart.
struct Filled {
  test::TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "kept.nendo";
  std::unique_ptr<LastMinute> ring;
  std::uint64_t next_tick = 0;
  HostTime now{1h};

  Filled(HostClock::duration span, std::size_t bytes) {
    std::uint32_t chunks = 0;
    auto setup =
        setup_bytes(test::setup_of(test::LoopUnderTest(Mode::type1, {.rings_of_ball = 8})), chunks);
    ring = std::make_unique<LastMinute>(std::move(setup), chunks, span, bytes);
  }
  void push(std::uint64_t ticks) {
    std::vector<std::byte> payload;
    ByteWriter writer(payload);
    for (std::uint64_t n = 0; n < ticks; ++n)
      put_entry(writer, flow::LoggedTick{next_tick++, now, now, 0});
    now += 1s;
    ring->push(payload, ticks, now);
  }
  Kept written() {
    std::filesystem::remove(path);
    const UniqueFd file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0600));
    REQUIRE(ring->write(file.get()));
    return read(path);
  }
};

/// Runs `child` in a process of its own and says which signal ended it; 0: none.
template <class Child>
int signal_that_ends(Child&& child) {
  const pid_t pid = ::fork();
  if (pid == 0) {
    // Without a core file, and without a word on the test's standard error.
    ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
    for (const int crash : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL})
      std::signal(crash, SIG_DFL); // doctest has handlers of its own
    child();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

} // namespace

TEST_SUITE("last_minute") {
  TEST_CASE("the last minute is kept, whole and in order, and what was before it is counted") {
    Filled filled(60s, 1 << 20);
    for (int second = 0; second < 200; ++second) {
      filled.push(10);
      const Kept kept = filled.written();
      const std::size_t seconds = std::min<std::size_t>(static_cast<std::size_t>(second) + 1, 61);
      REQUIRE(kept.ticks.size() == 10 * seconds);
      CHECK(kept.ticks.back() == filled.next_tick - 1);
      CHECK(kept.ticks.front() == filled.next_tick - kept.ticks.size());
      CHECK(kept.missing == kept.ticks.front());
      CHECK(kept.damages == 0);
      if (second > 70) second += 20;
    }
  }

  TEST_CASE("memory that is too small keeps less, whatever the sizes, and never anything broken") {
    std::mt19937 random(3);
    Filled filled(1h, 20'000);
    for (int turn = 0; turn < 400; ++turn) {
      filled.push(1 + random() % 80);
      if (turn % 7 != 0) continue;
      const Kept kept = filled.written();
      CHECK(kept.damages == 0);
      REQUIRE_FALSE(kept.ticks.empty());
      CHECK(kept.ticks.back() == filled.next_tick - 1);
      for (std::size_t at = 1; at < kept.ticks.size(); ++at)
        REQUIRE(kept.ticks[at] == kept.ticks[at - 1] + 1);
      CHECK(kept.missing + kept.ticks.size() == filled.next_tick);
    }
    filled.push(1000); // larger than an eighth of the memory
    CHECK(filled.written().missing >= 1000);
  }

  TEST_CASE("after freeze() nothing is pushed any more, and what is there can be written") {
    Filled filled(60s, 1 << 20);
    filled.push(5);
    filled.ring->freeze();
    filled.push(5);
    CHECK(filled.written().ticks == std::vector<std::uint64_t>{0, 1, 2, 3, 4});
  }

  TEST_CASE("a payload in whose middle its thread died is left out, and a reader knows it") {
    for (const std::size_t broken : {0U, 1U, 2U}) {
      CAPTURE(broken);
      Filled filled(60s, 1 << 20);
      std::vector<std::uint64_t> wanted;
      for (std::size_t payload = 0; payload < 3; ++payload) {
        if (payload != broken) wanted.insert(wanted.end(), {2 * payload, 2 * payload + 1});
        filled.push(2);
      }
      constexpr std::size_t tick_bytes = 26;
      memory_of(*filled.ring)[broken * 2 * tick_bytes + 5] ^= std::byte{1};
      filled.push(2); // whose thread did not die
      wanted.insert(wanted.end(), {6, 7});
      const Kept kept = filled.written();
      CHECK(kept.ticks == wanted);
      CHECK(kept.gaps == 1);
      CHECK(kept.damages == 1);
    }
  }

  TEST_CASE("keep() and the switch at the wrist make files while the loop runs") {
    RecordedLoop live(Mode::type1);
    const auto stem = live.folder.path() / "clay";
    live.record({.keep_last = 60s, .kept_stem = stem, .keep_on_switch = true, .chunk_time = 10ms});
    test::play(live, 30);
    live.recorder->save_last_minute();
    const auto first = std::filesystem::path(stem.string() + ".kept-1.nendo");
    const auto second = std::filesystem::path(stem.string() + ".kept-2.nendo");
    REQUIRE(test::eventually([&] { return std::filesystem::exists(first); }));
    REQUIRE(test::eventually([&] { return std::filesystem::file_size(first) > 100; }));
    // Turned on for 20 ms by the samples' own times.
    HostTime now = HostClock::now();
    for (std::uint64_t tick = 0; tick < 10; ++tick) {
      GloveSample sample = test::bent_sample(Side::left, 3, now += 11ms);
      sample.wrist_switch = tick < 5 ? WristSwitch::off : WristSwitch::on;
      live.test.rings[0]->try_push(sample);
      live.test.frame_after_tick(100 + tick);
    }
    const auto recorded = live.end();
    REQUIRE(recorded);
    CHECK(recorded->kept >= 2); // play() may have turned the switch, too
    const Kept kept = read(second);
    CHECK(kept.damages == 0);
    CHECK(kept.gaps == 0); // nothing is a minute old
    CHECK(kept.ticks.front() == 0);
    CHECK(live.warnings.size() == recorded->kept);
  }

  TEST_CASE("a crash writes the last minute before the process ends as it would have") {
    for (const int crash : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) {
      CAPTURE(crash);
      const test::TemporaryFolder folder;
      const auto stem = folder.path() / "clay";
      const int ended_by = signal_that_ends([&] {
        RecordedLoop live(Mode::type1);
        live.record({.keep_last = 60s, .kept_stem = stem, .chunk_time = 1ms});
        test::play(live, 100);
        std::this_thread::sleep_for(200ms); // the recorder's thread takes it meanwhile, mostly
        if (crash == SIGABRT) std::abort();
        ::kill(::getpid(), crash);
        ::pause();
      });
      CHECK(ended_by == crash);
      const Kept kept = read(stem.string() + ".crash.nendo");
      CHECK(kept.damages == 0);
      for (std::size_t at = 0; at < kept.ticks.size(); ++at)
        CHECK(kept.ticks[at] == at);
    }
  }

  TEST_CASE("a second thread that crashes does not end the process before the file is written") {
    for (const int second_crash : {SIGSEGV, SIGABRT}) {
      CAPTURE(second_crash);
      Filled filled(1h, std::size_t{64} << 20);
      constexpr std::uint64_t ticks = 150'000; // 4 MB a payload, so that writing them takes a while
      const int ended_by = signal_that_ends([&] {
        for (int payload = 0; payload < 8; ++payload)
          filled.push(ticks);
        const CrashHandler keeper(*filled.ring, filled.path);
        const std::jthread second([&] {
          while (::access(filled.path.c_str(), F_OK) != 0) {
          }
          ::raise(second_crash);
        });
        ::raise(SIGSEGV);
        ::pause();
      });
      CHECK((ended_by == SIGSEGV || ended_by == second_crash));
      const Kept kept = read(filled.path);
      CHECK(kept.damages == 0);
      CHECK(kept.ticks.size() == 8 * ticks);
    }
  }

  TEST_CASE("a recorder that has ended leaves crashes alone") {
    const test::TemporaryFolder folder;
    const auto stem = folder.path() / "clay";
    const int ended_by = signal_that_ends([&] {
      {
        RecordedLoop live(Mode::type1);
        live.record({.keep_last = 60s, .kept_stem = stem, .chunk_time = 1ms});
      }
      ::kill(::getpid(), SIGSEGV);
      ::pause();
    });
    CHECK(ended_by == SIGSEGV);
    CHECK_FALSE(std::filesystem::exists(stem.string() + ".crash.nendo"));
  }
}

} // namespace last_minute_test
