#include <nendo/flow/histogram.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

namespace histogram_test {

using namespace nendo::flow;
using namespace std::chrono_literals;

TEST_SUITE("histogram") {
  TEST_CASE("an empty histogram answers zero") {
    const Histogram histogram;
    CHECK(histogram.count() == 0);
    CHECK(histogram.percentile(0.5) == 0ns);
    CHECK(histogram.min() == 0ns);
    CHECK(histogram.max() == 0ns);
  }

  TEST_CASE("percentiles agree with a sorted list to 1.6 percent") {
    std::mt19937 random(9);
    std::lognormal_distribution<double> latency(std::log(50'000.0), 2.0);
    Histogram histogram;
    std::vector<std::int64_t> sorted;
    for (int n = 0; n < 20'000; ++n) {
      const auto ns = static_cast<std::int64_t>(latency(random));
      sorted.push_back(ns);
      histogram.record(std::chrono::nanoseconds(ns));
    }
    std::sort(sorted.begin(), sorted.end());
    for (const double fraction : {0.0, 0.01, 0.5, 0.9, 0.99, 0.9999, 1.0}) {
      const double rank = std::max(1.0, std::ceil(fraction * 20'000));
      const auto exact = static_cast<double>(sorted[static_cast<std::size_t>(rank) - 1]);
      const auto estimate = static_cast<double>(histogram.percentile(fraction).count());
      CAPTURE(fraction);
      CHECK(estimate >= exact);
      CHECK(estimate <= exact * 1.016 + 1.0);
    }
    CHECK(histogram.min().count() == sorted.front());
    CHECK(histogram.max().count() == sorted.back());
    CHECK(histogram.count() == 20'000);
  }

  TEST_CASE("values out of range are kept: negative ones as zero, hours in the last bucket") {
    Histogram histogram;
    histogram.record(-5ms);
    CHECK(histogram.max() == 0ns);
    histogram.record(std::chrono::hours(48));
    CHECK(histogram.percentile(1.0) == std::chrono::hours(48));
    CHECK(histogram.percentile(0.5) == 0ns);
    CHECK(histogram.count() == 2);
  }

  TEST_CASE("every power of two lands in a bucket that contains it") {
    for (int shift = 0; shift < 39; ++shift) {
      for (const std::int64_t delta : {-1, 0, 1}) {
        const std::int64_t ns = (std::int64_t{1} << shift) + delta;
        Histogram histogram;
        histogram.record(std::chrono::nanoseconds(ns));
        histogram.record(std::chrono::hours(1)); // so that max() does not clamp the answer
        CHECK(histogram.percentile(0.5).count() >= ns);
        CHECK(static_cast<double>(histogram.percentile(0.5).count()) <=
              1.016 * static_cast<double>(ns));
      }
    }
  }

  TEST_CASE("its classes, shortest first, hold every value, and a value may be many") {
    Histogram one_by_one;
    Histogram together;
    for (const auto& [ns, count] : {std::pair{5, 3}, {1'000, 7}, {2'000'000, 2}}) {
      together.record(std::chrono::nanoseconds(ns), static_cast<std::uint64_t>(count));
      for (int n = 0; n < count; ++n)
        one_by_one.record(std::chrono::nanoseconds(ns));
    }
    together.record(std::chrono::hours(1), 0); // none of that
    std::uint64_t seen = 0;
    std::chrono::nanoseconds before{-1};
    together.for_each([&](std::chrono::nanoseconds longest, std::uint64_t count) {
      CHECK(longest > before);
      seen += count;
      before = longest;
      CHECK(one_by_one.percentile(static_cast<double>(seen) / 12.0) == longest);
    });
    CHECK(seen == 12);
    CHECK(before == together.max());
    CHECK(together.max() == one_by_one.max());
  }
}

} // namespace histogram_test
