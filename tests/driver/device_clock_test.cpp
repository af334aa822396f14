#include "stream/device_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include <doctest/doctest.h>

namespace device_clock_test {

using namespace nendo;
using namespace nendo::driver;
using namespace std::chrono_literals;
using std::chrono::nanoseconds;

namespace {

HostTime host(nanoseconds since_begin) {
  return HostTime(1'000'000s + since_begin);
}

double ms(HostClock::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

/// A device that sends 100 records per second, and a host that takes them late: exponentially,
/// about a millisecond, and now and then not at all for a while, and then many at once.
class Simulation {
public:
  struct Event {
    nanoseconds sent;    ///< host time
    nanoseconds device;  ///< the device's own
    nanoseconds arrival; ///< host time
  };
  Simulation(double drift_ppm, nanoseconds longest_stall, unsigned seed = 1)
      : rate_(1.0 + drift_ppm * 1e-6), longest_stall_(longest_stall), random_(seed) {}

  Event next() {
    now_ += 10ms;
    if (random_() % 2000 == 0) {
      stalled_until_ = now_ + nanoseconds(static_cast<std::int64_t>(
                                  uniform() * static_cast<double>(longest_stall_.count())));
    }
    const nanoseconds delay(static_cast<std::int64_t>(-1e6 * std::log(1.0 - uniform())));
    arrival_ = std::max({arrival_, now_ + delay, stalled_until_});
    const auto elapsed = static_cast<std::int64_t>(static_cast<double>(now_.count()) * rate_);
    return {now_, 5s + nanoseconds(elapsed), arrival_};
  }
  nanoseconds now() const { return now_; }

private:
  double uniform() { return static_cast<double>(random_()) / 4294967296.0; }

  double rate_;
  nanoseconds longest_stall_;
  std::mt19937 random_;
  nanoseconds now_{}, stalled_until_{}, arrival_{};
};

/// The largest error of to_host() between `from` and `to`, and of the bare arrival.
struct Errors {
  double estimate_ms = 0.0;
  double arrival_ms = 0.0;
};

Errors run(DeviceClock& clock, Simulation& simulation, nanoseconds from, nanoseconds to) {
  Errors errors;
  HostTime last = host(-1h);
  bool lawful = true;
  while (simulation.now() < to) {
    const auto event = simulation.next();
    const HostTime estimate = clock.to_host(event.device, host(event.arrival));
    lawful = lawful && estimate <= host(event.arrival) && estimate >= last;
    last = estimate;
    if (event.sent < from) continue;
    errors.estimate_ms = std::max(errors.estimate_ms, std::abs(ms(estimate - host(event.sent))));
    errors.arrival_ms = std::max(errors.arrival_ms, ms(event.arrival - event.sent));
  }
  CHECK(lawful);
  return errors;
}

} // namespace

TEST_SUITE("device_clock") {
  TEST_CASE("ticks become time exactly, and wrap after ten hours") {
    TickUnwrapper unwrapper;
    CHECK(unwrapper.unwrap(0) == 0ns);
    CHECK(unwrapper.unwrap(9) == 78'125ns);
    CHECK(unwrapper.unwrap(115'200) == 1s);
    CHECK(unwrapper.unwrap(115'200) == 1s);
    unwrapper.unwrap(0xFFFFFFFF);
    CHECK(unwrapper.unwrap(0) == nanoseconds(37'282'702'222'222)); // 2^32 / 115200 s
    unwrapper.reset();
    CHECK(unwrapper.unwrap(115'200) == 1s);
  }

  TEST_CASE("ticks do not drift over years") {
    TickUnwrapper unwrapper;
    constexpr std::uint64_t hour = 3600 * 115'200ULL;
    constexpr std::uint64_t hours = 30ULL * 365 * 24;
    nanoseconds time{};
    for (std::uint64_t k = 0; k <= hours; ++k)
      time = unwrapper.unwrap(static_cast<std::uint32_t>(k * hour));
    CHECK(time == std::chrono::hours(hours));
  }

  TEST_CASE("over hours of jitter, stalls and drift a record's time errs by less than half a ms") {
    for (const double drift : {50.0, -50.0, 0.0}) {
      CAPTURE(drift);
      DeviceClock clock;
      Simulation simulation(drift, 100ms);
      const Errors errors = run(clock, simulation, 10s, 3h);
      CHECK(errors.estimate_ms < 0.5);
      CHECK(errors.arrival_ms > 80.0);
    }
  }

  TEST_CASE("stalls of several seconds, every twenty seconds or so, do not move it") {
    DeviceClock clock;
    Simulation simulation(50.0, 5s, 3);
    const Errors errors = run(clock, simulation, 30s, 20min);
    CHECK(errors.estimate_ms < 0.5);
    CHECK(errors.arrival_ms > 3000.0);
  }

  TEST_CASE("through the unwrapped ticks of a glove it is as exact, across their wrap") {
    TickUnwrapper unwrapper;
    DeviceClock clock;
    Simulation simulation(50.0, 100ms);
    double worst_ms = 0.0;
    while (simulation.now() < 10min) {
      const auto event = simulation.next();
      const auto ticks = static_cast<std::uint64_t>(event.device.count()) * 9 / 78'125;
      const auto sent = static_cast<std::uint32_t>(ticks - 300 * 115'200ULL); // wraps at 5 minutes
      const HostTime estimate = clock.to_host(unwrapper.unwrap(sent), host(event.arrival));
      if (event.sent > 10s)
        worst_ms = std::max(worst_ms, std::abs(ms(estimate - host(event.sent))));
    }
    CHECK(worst_ms < 0.5);
  }

  TEST_CASE("a clock that restarted is followed at once, reset or not") {
    for (const bool is_reset : {true, false}) {
      DeviceClock clock;
      Simulation before(50.0, 100ms);
      run(clock, before, 0s, 2min);
      if (is_reset) clock.reset();
      for (nanoseconds sent = 3min; sent < 4min; sent += 10ms) {
        const HostTime estimate = clock.to_host(sent - 179s, host(sent));
        CHECK(std::abs(ms(estimate - host(sent))) < 0.2);
      }
    }
  }

  TEST_CASE("a clock that jumps ahead is followed at once, one that falls behind within 64 s") {
    for (const nanoseconds jump : {3s, -3s}) {
      DeviceClock clock;
      nanoseconds sent{};
      for (; sent < 2min; sent += 10ms)
        clock.to_host(sent, host(sent));
      sent += 3s;
      const nanoseconds followed = sent + (jump > 0s ? 0s : 66s);
      for (; sent < 4min; sent += 10ms) {
        const HostTime estimate = clock.to_host(sent + jump, host(sent));
        CHECK(estimate <= host(sent));
        if (sent >= followed) CHECK(std::abs(ms(estimate - host(sent))) < 0.1);
      }
    }
  }

  TEST_CASE("a clock that restarted a few seconds back is noticed by its running back") {
    DeviceClock clock;
    for (nanoseconds sent{}; sent < 1min; sent += 10ms)
      clock.to_host(sent, host(sent));
    for (nanoseconds sent = 1min; sent < 2min; sent += 10ms)
      CHECK(std::abs(ms(clock.to_host(sent - 5s, host(sent)) - host(sent))) < 0.1);
  }

  TEST_CASE("the soonest record so far counts at once, also within the first second") {
    DeviceClock clock;
    clock.to_host(0s, host(50ms));
    clock.to_host(60ms, host(60ms));
    CHECK(std::abs(ms(clock.to_host(70ms, host(90ms)) - host(70ms))) < 0.1);
  }

  TEST_CASE("no result is later than its arrival, or before the last one, whatever the delays") {
    std::mt19937 random(12);
    for (int round = 0; round < 100; ++round) {
      DeviceClock clock;
      nanoseconds device{}, arrival{};
      HostTime last = host(-1s);
      for (int k = 0; k < 2000; ++k) {
        device += nanoseconds(random() >> random() % 32);
        const nanoseconds delay(random() >> random() % 32);
        arrival = std::max(arrival, device + device / 2500 * (round % 3 - 1) + delay);
        const HostTime result = clock.to_host(device, host(arrival));
        CHECK(result <= host(arrival));
        CHECK(result >= last);
        last = result;
      }
      CHECK(clock.to_host(device + 1ms, last - 1s) == last - 1s); // an arrival that runs back
    }
  }

  TEST_CASE("what was learnt before a long silence is forgotten, the drift excepted") {
    DeviceClock clock;
    Simulation simulation(50.0, 100ms);
    run(clock, simulation, 0s, 2min);
    for (nanoseconds sent = 1h; sent < 1h + 1min; sent += 10ms) {
      // It runs 50 ppm fast as before, and lost 50 ms meanwhile.
      const nanoseconds device = 5s + sent + sent / 20'000 - 50ms;
      CHECK(std::abs(ms(clock.to_host(device, host(sent)) - host(sent))) < 0.1);
    }
  }

  TEST_CASE("after a silence of minutes it continues") {
    DeviceClock clock;
    Simulation simulation(50.0, 100ms);
    run(clock, simulation, 0s, 2min);
    while (simulation.now() < 10min)
      (void)simulation.next();
    CHECK(run(clock, simulation, 10min + 10s, 11min).estimate_ms < 0.5);
  }

  TEST_CASE("records that arrive together are distinguished by when they were taken") {
    DeviceClock clock;
    for (nanoseconds sent = 0s; sent < 10s; sent += 10ms)
      clock.to_host(sent, host(sent));
    for (int k = 0; k < 20; ++k) {
      const nanoseconds sent = 10s + k * 10ms;
      CHECK(std::abs(ms(clock.to_host(sent, host(10s + 200ms)) - host(sent))) < 0.1);
    }
  }

  TEST_CASE("absurd device times give the arrival or less, and do no lasting harm") {
    DeviceClock clock;
    std::mt19937_64 random(5);
    for (int round = 0; round < 50; ++round) {
      const nanoseconds base = round * 1min;
      for (int k = 0; k < 200; ++k) {
        const HostTime arrival = host(base + k * 10ms);
        const nanoseconds absurd(static_cast<std::int64_t>(random() >> (random() % 64)) *
                                 (k % 2 == 0 ? 1 : -1));
        CHECK(clock.to_host(absurd, arrival) <= arrival);
      }
      for (const nanoseconds extreme : {nanoseconds::max(), nanoseconds::min()})
        CHECK(clock.to_host(extreme, host(base + 2s)) == host(base + 2s));
      clock.to_host(base, host(base + 20s));
      const HostTime good = clock.to_host(base + 10ms, host(base + 20s + 10ms));
      CHECK(std::abs(ms(good - host(base + 20s + 10ms))) < 0.1);
    }
  }
}

} // namespace device_clock_test
