#include "bench/latency_probe.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace latency_probe_test {

using namespace nendo;
using namespace nendo::bench;

namespace {

struct Measured {
  Result<void> result;
  std::vector<HostClock::duration> driver;
  std::vector<HostClock::duration> bare;
};

Measured measure(const LatencyOptions& options, bool stopped = false) {
  const std::atomic<bool> stop{stopped};
  Measured measured;
  measured.result =
      measure_latency(options,
                      {[&](HostClock::duration time) { measured.driver.push_back(time); },
                       [&](HostClock::duration time) { measured.bare.push_back(time); }},
                      stop);
  return measured;
}

} // namespace

TEST_SUITE("latency probe") {
  TEST_CASE("every record is timed on both paths, and none takes no time") {
    for (const Line line : {Line::pseudo_terminal, Line::socket_pair}) {
      const auto measured = measure({line, 50, 400.0});
      REQUIRE(measured.result);
      CHECK(measured.driver.size() == 50);
      CHECK(measured.bare.size() == 50);
      for (const auto& times : {measured.driver, measured.bare}) {
        for (const auto time : times)
          REQUIRE(time > std::chrono::microseconds(1)); // a system call and a thread switch
      }
    }
  }

  TEST_CASE("a rate that the line cannot carry is refused, and a stop ends the measurement") {
    for (const double rate_hz : {0.0, -1.0, 481.0, 0.0 / 0.0}) {
      const auto measured = measure({Line::socket_pair, 10, rate_hz});
      REQUIRE_FALSE(measured.result);
      CHECK(measured.result.error().code == Errc::usage);
    }
    const auto stopped = measure({Line::socket_pair, 1'000'000, 400.0}, true);
    CHECK(stopped.result);
    CHECK(stopped.driver.empty());
  }
}

} // namespace latency_probe_test
