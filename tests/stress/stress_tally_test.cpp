// How a stress test counts: percentiles of scheduled ticks, and the causes of lateness.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "stress/report.hpp"
#include "stress/tick_tally.hpp"

namespace stress_tally_test {

using namespace nendo;
using namespace nendo::stress;
using namespace std::chrono_literals;
using flow::TickRecord;

namespace {

constexpr HostTime first_tick(1000s);
constexpr auto period = 1ms;

flow::PaceOptions at_1khz() {
  flow::PaceOptions pace;
  pace.rate_hz = 1000.0;
  return pace;
}

/// A tick that woke so late and then worked as long: 10 % of it each for input, hands and
/// publishing, the rest for the deformation.
TickRecord record(std::uint64_t tick, HostClock::duration late, std::uint32_t work_ns,
                  std::uint32_t missed = 0) {
  TickRecord made;
  made.tick = tick;
  made.scheduled = first_tick + tick * period;
  made.woke = made.scheduled + late;
  made.drained_ns = work_ns / 10;
  made.posed_ns = work_ns / 5;
  made.solved_ns = work_ns - work_ns / 10;
  made.published_ns = work_ns;
  made.missed = missed;
  return made;
}

UsualTimes usually(std::chrono::nanoseconds each) {
  UsualTimes usual;
  usual.fill(each);
  return usual;
}

double relative(std::chrono::nanoseconds measured, std::chrono::nanoseconds expected) {
  return std::abs(static_cast<double>((measured - expected).count())) /
         static_cast<double>(expected.count());
}

} // namespace

TEST_SUITE("stress tally") {
  TEST_CASE("a stall counts for every tick that it swallowed, not for one") {
    // 990 ticks in time, then one 100 ms late that swallowed 99 deadlines, over and over.
    TickTally tally(at_1khz());
    std::vector<std::chrono::nanoseconds> every; // each deadline's wait, by definition
    std::uint64_t tick = 0;
    for (int round = 0; round < 5; ++round) {
      for (int n = 0; n < 900; ++n) {
        tally.add(record(tick++, 10us, 100'000), nullptr);
        every.push_back(10us);
      }
      tick += 99;
      tally.add(record(tick++, 1ms, 100'000, 99), nullptr);
      for (int n = 0; n <= 99; ++n)
        every.push_back(1ms + n * period);
    }
    std::sort(every.begin(), every.end());
    const Distribution& lateness = tally[Measure::lateness];
    CHECK(lateness.corrected.count() == every.size());
    CHECK(lateness.raw.count() == tally.ticks());
    for (const double fraction : {0.5, 0.89, 0.95, 0.99, 0.999}) {
      const auto rank =
          static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(every.size())));
      CHECK(relative(lateness.corrected.percentile(fraction), every[rank - 1]) < 0.016);
    }
    CHECK(lateness.raw.percentile(0.99) < 11us); // what a table without correction would say
    CHECK(lateness.corrected.percentile(0.95) > 40ms);
  }

  TEST_CASE("work longer than a period stands for the ticks behind it, as HdrHistogram has it") {
    TickTally tally(at_1khz());
    tally.add(record(0, 0us, 3'500'000), nullptr);
    const auto& work = tally[Measure::work];
    CHECK(work.raw.count() == 1);
    CHECK(work.corrected.count() == 4); // 3.5, 2.5, 1.5 and 0.5 ms
    CHECK(relative(work.corrected.min(), 500us) < 0.016);
  }

  TEST_CASE("stages, input age and end to end are read off the record") {
    TickTally tally(at_1khz());
    TickRecord one = record(0, 5us, 100'000);
    one.samples = 2;
    one.input = one.woke - 300us;
    tally.add(one, nullptr);
    tally.add(record(1, 5us, 100'000), nullptr); // without a sample there is no age
    CHECK(relative(tally.stage(Phase::input).max(), 10us) < 0.016);
    CHECK(relative(tally.stage(Phase::deform).max(), 70us) < 0.016);
    CHECK(tally[Measure::input_age].raw.count() == 1);
    CHECK(relative(tally[Measure::input_age].raw.max(), 310us) < 0.016);
    CHECK(relative(tally[Measure::end_to_end].raw.max(), 400us) < 0.016);
    CHECK(tally.samples() == 2);
  }

  TEST_CASE("the worst are the ten latest, latest first, and the outage the longest step") {
    TickTally tally(at_1khz());
    std::vector<int> late_us(500);
    std::iota(late_us.begin(), late_us.end(), 1);
    std::shuffle(late_us.begin(), late_us.end(), std::mt19937(5));
    HostTime before{};
    std::chrono::nanoseconds longest{};
    for (std::size_t tick = 0; tick < late_us.size(); ++tick) {
      const TickRecord made = record(tick, std::chrono::microseconds(late_us[tick]), 1000);
      if (before != HostTime{}) longest = std::max(longest, made.woke - before);
      before = made.woke;
      tally.add(made, nullptr);
    }
    REQUIRE(tally.worst().size() == TickTally::max_worst);
    for (std::size_t k = 0; k < tally.worst().size(); ++k)
      CHECK(tally.worst()[k].lateness == std::chrono::microseconds(500 - k));
    CHECK(tally.longest_outage() == longest);
  }

  TEST_CASE("the phase that took the time is named: the wake-up, or the stage before it") {
    const auto quick = record(4, 0us, 100'000);
    auto incident = incident_of(quick, record(5, 3ms, 100'000), period);
    CHECK(incident.phase == Phase::wake);
    CHECK(incident.lateness == 3ms);
    CHECK(incident.phase_time == 3ms);
    // The tick before worked for 4.5 ms; its deformation, 70 % of that, continued beyond
    // deadline 5.
    incident = incident_of(record(4, 0us, 4'500'000), record(9, 0us, 100'000, 4), period);
    CHECK(incident.phase == Phase::deform);
    CHECK(incident.due == first_tick + 5 * period);
    CHECK(incident.lateness == 4ms);
    CHECK(incident.missed == 4);
    CHECK(incident.phase_time == 4'050us - 1ms);
  }

  TEST_CASE("who waited was preempted, who worked as usual worked too long, and else the machine "
            "stopped") {
    auto late = incident_of(record(4, 0us, 100'000), record(5, 3ms, 100'000), period);
    CHECK(cause_of(late, usually(1us), 2ms) == Cause::preemption);
    CHECK(cause_of(late, usually(1us), 1ms) == Cause::host_gap);
    CHECK(cause_of(late, usually(1us), std::nullopt) == Cause::unexplained);
    late = incident_of(record(4, 0us, 4'500'000), record(9, 0us, 100'000, 4), period);
    CHECK(cause_of(late, usually(3ms), 0ms) == Cause::own_work);
    CHECK(cause_of(late, usually(3ms), std::nullopt) == Cause::own_work);
    CHECK(cause_of(late, usually(100us), 0ms) == Cause::host_gap);
    CHECK(cause_of(late, usually(3ms), 4ms) == Cause::preemption);
    TickRecord burst = record(4, 0us, 4'500'000);
    burst.drained_ns = burst.posed_ns = burst.solved_ns = 4'400'000;
    late = incident_of(burst, record(9, 0us, 100'000, 4), period);
    CHECK(late.phase == Phase::input);
    CHECK(cause_of(late, usually(3ms), 0ms) == Cause::input);
  }

  TEST_CASE("lateness without a known cause is not counted as explained") {
    TickTally tally(at_1khz());
    CHECK(tally.explained() == 1.0);
    tally.add(record(0, 0us, 1000), nullptr);
    tally.add(record(1, 900us, 1000), nullptr); // below the threshold: need not be explained
    CHECK(tally.explained() == 1.0);
    tally.add(record(3, 5ms, 1000), nullptr);
    CHECK(tally.explained() == 0.0);
  }

  TEST_CASE("the kernel's count of waiting is read, and anything else is not") {
    CHECK(parse_run_delay("1234 567 8") == 567ns);
    CHECK(parse_run_delay("0 0 0") == 0ns);
    for (const char* text : {"", "1", "1 ", "1 x 2", "1 -5 2", "1 567", "1 99999999999999999999 1"})
      CHECK_FALSE(parse_run_delay(text));
  }

  TEST_CASE("a course over time has at most so many slices, and loses nothing") {
    LatenessTrace course;
    std::uint64_t count = 0;
    for (int n = 0; n < 100'000; ++n, ++count)
      course.add(first_tick + n * 7ms, n == 77'777 ? 50ms : 1us);
    CHECK(course.slices().size() <= LatenessTrace::max_slices);
    CHECK(course.slices().size() > LatenessTrace::max_slices / 4);
    std::uint64_t counted = 0;
    std::chrono::nanoseconds sum{};
    std::size_t latest = 0;
    for (std::size_t k = 0; k < course.slices().size(); ++k) {
      counted += course.slices()[k].count;
      sum += course.slices()[k].sum;
      if (course.slices()[k].max == 50ms) latest = k;
    }
    CHECK(counted == count);
    CHECK(sum == 99'999 * 1us + 50ms);
    CHECK(latest == static_cast<std::size_t>(77'777 * 7ms / course.slice_length()));
  }

  TEST_CASE("an HdrHistogram file has a line a value that rises to all of them") {
    flow::Histogram lateness;
    for (int n = 1; n <= 1000; ++n)
      lateness.record(std::chrono::microseconds(n));
    const std::string text = hgrm(lateness);
    CHECK(text.find("       Value     Percentile TotalCount 1/(1-Percentile)\n\n") == 0);
    CHECK(text.find("#[Mean    =      50") != std::string::npos);
    CHECK(text.find("Total count    =         1000]") != std::string::npos);
    double value = 0.0;
    double fraction = 0.0;
    unsigned long long count = 0;
    const char* line = text.c_str() + text.find("\n\n") + 2;
    double before = 0.0;
    while (std::sscanf(line, "%lf %lf %llu", &value, &fraction, &count) == 3) {
      CHECK(value > before);
      CHECK(fraction == doctest::Approx(static_cast<double>(count) / 1000.0));
      before = value;
      line = std::strchr(line, '\n') + 1;
    }
    CHECK(count == 1000);
    CHECK(value == 1000.0);
  }
}

} // namespace stress_tally_test
