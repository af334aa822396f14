#include <nendo/flow/pacer.hpp>

#include <algorithm>
#include <random>
#include <thread>

#include <doctest/doctest.h>

namespace pacer_test {

using namespace nendo;
using namespace nendo::flow;
using namespace std::chrono_literals;

namespace {

// Long past for wait(), which then returns at once: time is what the test says it is.
constexpr HostTime start(1s);
constexpr auto period = 1ms;

PaceOptions at_1khz(OverrunPolicy policy, unsigned max_catch_up = 4) {
  PaceOptions options;
  options.rate_hz = 1000.0;
  options.policy = policy;
  options.max_catch_up = max_catch_up;
  return options;
}

/// A loop in simulated time whose ticks take what `work` says; calls see(due, begin) at each tick.
template <class Work, class See>
Pacer simulate(const PaceOptions& options, int ticks, Work&& work, See&& see) {
  Pacer pacer(options, start);
  HostTime now = start;
  for (int n = 0; n < ticks; ++n) {
    now = std::max(now, pacer.next_deadline());
    const auto due = pacer.wait();
    see(due, now);
    now += work();
    pacer.end_tick(now);
  }
  return pacer;
}

/// Mostly short ticks, now and then one of several periods.
auto random_work(std::uint32_t seed) {
  return [random = std::mt19937(seed)]() mutable -> HostClock::duration {
    return random() % 10 == 0 ? std::chrono::microseconds(random() % 9000)
                              : std::chrono::microseconds(random() % 900);
  };
}

} // namespace

TEST_SUITE("pacer") {
  TEST_CASE("ticks in time are all on the grid, whatever the policy") {
    for (const auto policy :
         {OverrunPolicy::skip, OverrunPolicy::catch_up, OverrunPolicy::re_anchor}) {
      std::uint64_t expected = 0;
      simulate(
          at_1khz(policy), 1000, [] { return 999us; },
          [&](const Pacer::Due& due, HostTime begin) {
            REQUIRE(due.number == expected);
            REQUIRE(due.scheduled == start + expected * period);
            REQUIRE(due.scheduled == begin);
            REQUIRE(due.missed == 0);
            ++expected;
          });
    }
  }

  TEST_CASE("skip: every deadline is a tick or missed, and no tick begins a period late") {
    std::uint64_t accounted = 0;
    std::uint64_t missed = 0;
    const Pacer pacer = simulate(at_1khz(OverrunPolicy::skip), 5000, random_work(1),
                                 [&](const Pacer::Due& due, HostTime begin) {
                                   REQUIRE(due.number == accounted + due.missed);
                                   REQUIRE(due.scheduled == start + due.number * period);
                                   REQUIRE(begin == due.scheduled);
                                   accounted = due.number + 1;
                                   missed += due.missed;
                                 });
    CHECK(missed > 100);
    CHECK(pacer.next() >= accounted);
  }

  TEST_CASE("catch-up: late ticks run in order, never from further behind than the bound") {
    for (const unsigned most : {1U, 4U, 1000U}) {
      std::uint64_t accounted = 0;
      std::uint64_t missed = 0;
      std::uint64_t late = 0;
      simulate(at_1khz(OverrunPolicy::catch_up, most), 5000, random_work(2),
               [&](const Pacer::Due& due, HostTime begin) {
                 REQUIRE(due.number == accounted + due.missed);
                 REQUIRE(due.scheduled == start + due.number * period);
                 REQUIRE(begin - due.scheduled <= most * period);
                 accounted = due.number + 1;
                 missed += due.missed;
                 late += begin > due.scheduled ? 1U : 0U;
               });
      CHECK(late > 100);
      CHECK((missed == 0) == (most == 1000));
    }
  }

  TEST_CASE("re-anchor: no number is missed, and the next period begins where the overrun ended") {
    std::uint64_t expected = 0;
    HostTime before{};
    std::uint64_t slipped = 0;
    simulate(at_1khz(OverrunPolicy::re_anchor), 5000, random_work(3),
             [&](const Pacer::Due& due, HostTime begin) {
               REQUIRE(due.number == expected++);
               REQUIRE(due.missed == 0);
               REQUIRE(begin == due.scheduled);
               if (before != HostTime{}) REQUIRE(due.scheduled - before >= period);
               slipped += due.scheduled - start > due.number * period ? 1U : 0U;
               before = due.scheduled;
             });
    CHECK(slipped > 4000);
  }

  TEST_CASE("a tick that ends at the next deadline or later has overrun it") {
    Pacer pacer(at_1khz(OverrunPolicy::skip), start);
    CHECK_FALSE(pacer.end_tick(start + period - 1ns));
    CHECK(pacer.end_tick(start + 2 * period));
    CHECK(pacer.next() == 3);
  }

  TEST_CASE("after years asleep the missed deadlines are still counted, at their most") {
    const HostTime years_ago = HostClock::now() - 24h * 366;
    Pacer pacer(at_1khz(OverrunPolicy::skip), years_ago);
    pacer.end_tick(years_ago + 24h * 365);
    CHECK(pacer.next() == 1000ULL * 86'400 * 365 + 1);
    CHECK(pacer.wait().missed == 0xFFFFFFFFU);
  }

  TEST_CASE("no wait ends before its deadline, with the spin tail or without") {
    for (const bool spin : {false, true}) {
      PaceOptions options = at_1khz(OverrunPolicy::skip);
      options.spin = spin;
      Pacer pacer(options, HostClock::now() + 1ms);
      for (int n = 0; n < 50; ++n) {
        const auto due = pacer.wait();
        REQUIRE(HostClock::now() >= due.scheduled);
        REQUIRE(due.woke >= due.scheduled);
        if (!spin) REQUIRE(due.spun == 0ns);
        pacer.end_tick(due.woke);
      }
    }
  }

  TEST_CASE("a deadline that is nearer than the margin is spun to, without a sleep") {
    PaceOptions options = at_1khz(OverrunPolicy::skip);
    options.rate_hz = 10.0;
    options.spin = true; // by the most at this rate, 100 us
    HostClock::duration spun{};
    // A busy machine may take the CPU away before the first look at the clock.
    for (int n = 0; n < 10'000 && spun == 0ns; ++n)
      spun = Pacer(options, HostClock::now() + 50us).wait().spun;
    CHECK(spun > 0ns);
  }

  TEST_CASE("paced by samples, a tick comes with each sample, and without any after a while") {
    PaceOptions options = at_1khz(OverrunPolicy::sample);
    options.longest_wait = 20ms;
    EventCount event_count;
    Pacer pacer(options, HostClock::now(), &event_count);
    const HostTime begin = HostClock::now();
    const auto silent = pacer.wait();
    CHECK(HostClock::now() >= begin + options.longest_wait);
    CHECK(silent.scheduled >= begin + options.longest_wait);
    CHECK_FALSE(pacer.end_tick(HostClock::now()));
    options.longest_wait = 1h;
    Pacer patient(options, HostClock::now(), &event_count);
    std::thread glove([&] { event_count.notify(); });
    const auto due = patient.wait();
    glove.join();
    CHECK(due.number == 0);
    CHECK(due.scheduled <= HostClock::now());
  }

  TEST_CASE("policies are read as they are written") {
    for (const char* text : {"skip", "catch-up:1", "catch-up:1000", "re-anchor", "sample"}) {
      PaceOptions options;
      CHECK(parse_policy(text, options));
      CHECK(describe_policy(options) == text);
    }
    PaceOptions options;
    CHECK(parse_policy("catch-up", options));
    CHECK(options.max_catch_up == PaceOptions{}.max_catch_up);
    for (const char* text : {"", "hurry", "skip:2", "catch-up:", "catch-up:0", "catch-up:1001",
                             "catch-up:-1", "catch-up:2x", "catch-up:99999999999999", "SKIP"}) {
      PaceOptions untouched;
      const auto parsed = parse_policy(text, untouched);
      REQUIRE_FALSE(parsed);
      CHECK(parsed.error().message.starts_with(std::string(text) + ": use skip, "));
      CHECK(untouched.policy == OverrunPolicy::skip);
      CHECK(untouched.max_catch_up == PaceOptions{}.max_catch_up);
    }
  }
}

} // namespace pacer_test
