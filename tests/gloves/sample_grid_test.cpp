#include "gloves/sample_grid.hpp"

#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace sample_grid_test {

using namespace nendo;
using nendo::gloves::SampleGrid;
using std::chrono::microseconds;
using std::chrono::nanoseconds;

namespace {

const HostTime start{std::chrono::hours(100)};

struct Emitted {
  HostTime time;
  std::uint64_t sequence;
};

std::vector<GloveSample> irregular_samples(std::mt19937& random, int count) {
  std::uniform_int_distribution<int> gap_us(0, 25'000);
  std::vector<GloveSample> samples(static_cast<std::size_t>(count));
  HostTime time = start;
  std::uint64_t sequence = 0;
  for (auto& sample : samples) {
    sample.arrival = time;
    sample.sequence = sequence++;
    time += microseconds(gap_us(random));
  }
  return samples;
}

// The reference: of all samples that had arrived by then, the last.
std::uint64_t newest_at(const std::vector<GloveSample>& samples, HostTime time) {
  std::uint64_t newest = 0;
  for (const auto& sample : samples)
    if (sample.arrival <= time) newest = sample.sequence;
  return newest;
}

} // namespace

TEST_SUITE("sample grid") {
  TEST_CASE("pose k is of the newest sample at start + k / rate, whenever the program runs") {
    std::mt19937 random(1);
    for (const double rate_hz : {1.0, 29.97, 90.0, 1000.0}) {
      const auto samples = irregular_samples(random, 400);
      const HostTime end = samples.back().arrival;
      SampleGrid grid(start, rate_hz);
      std::vector<Emitted> emitted;
      const auto emit = [&](HostTime time, const GloveSample& sample) {
        emitted.push_back({time, sample.sequence});
        return true;
      };
      std::uniform_int_distribution<int> nap_us(0, 60'000);
      std::size_t taken = 0;
      for (HostTime now = start; now < end;
           now = std::min(end, now + microseconds(nap_us(random)))) {
        for (; taken < samples.size() && samples[taken].arrival <= now; ++taken)
          REQUIRE(grid.take(samples[taken], emit));
        REQUIRE(grid.pass_time(now, emit));
      }
      REQUIRE(emitted.size() > 3);
      for (std::size_t k = 0; k < emitted.size(); ++k) {
        const double due_s = static_cast<double>(k) / rate_hz;
        CHECK(std::abs(to_seconds(emitted[k].time - start) - due_s) < 2e-9);
        CHECK(emitted[k].sequence == newest_at(samples, emitted[k].time));
      }
    }
  }

  TEST_CASE("without a rate each sample comes once, when it arrived") {
    std::mt19937 random(2);
    const auto samples = irregular_samples(random, 50);
    SampleGrid grid(start, 0.0);
    std::vector<Emitted> emitted;
    const auto emit = [&](HostTime time, const GloveSample& sample) {
      emitted.push_back({time, sample.sequence});
      return true;
    };
    for (const auto& sample : samples) {
      CHECK(grid.take(sample, emit));
      CHECK(grid.pass_time(sample.arrival + microseconds(100), emit));
    }
    REQUIRE(emitted.size() == samples.size());
    for (std::size_t n = 0; n < samples.size(); ++n) {
      CHECK(emitted[n].time == samples[n].arrival);
      CHECK(emitted[n].sequence == n);
    }
  }

  TEST_CASE("who wants no more is not asked again") {
    SampleGrid grid(start, 100.0);
    int wanted = 5;
    const auto emit = [&](HostTime, const GloveSample&) { return --wanted > 0; };
    GloveSample sample;
    sample.arrival = start;
    CHECK(grid.take(sample, emit));
    CHECK_FALSE(grid.pass_time(start + std::chrono::hours(1), emit));
    CHECK(wanted == 0);
  }

  TEST_CASE("before the first sample there is nothing to give") {
    SampleGrid grid(start, 100.0);
    CHECK(grid.pass_time(start + std::chrono::seconds(5), [](HostTime, const GloveSample&) {
      FAIL("there was no sample");
      return true;
    }));
  }
}

} // namespace sample_grid_test
