#include "bench/cyclictest.hpp"

#include <doctest/doctest.h>

namespace cyclictest_test {

using namespace nendo;
using namespace nendo::bench;

TEST_SUITE("cyclictest") {
  TEST_CASE("the histogram of a report is read, in microseconds") {
    const auto histogram = parse_cyclictest(R"({"file_version": 1, "thread": {"0": {
      "histogram": {"11": 1, "14": 97, "90": 2}, "cycles": 100, "min": 11, "max": 90}}})");
    REQUIRE(histogram);
    CHECK(histogram->count() == 100);
    CHECK(histogram->min() == std::chrono::microseconds(11));
    CHECK(histogram->max() == std::chrono::microseconds(90));
    CHECK(histogram->percentile(0.5).count() == doctest::Approx(14'000).epsilon(0.016));
  }

  TEST_CASE("what is no such report is an error") {
    for (const char* text :
         {"", "x", "[]", "{}", R"({"thread": []})", R"({"thread": {"0": 5}})",
          R"({"thread": {"0": {"histogram": 5}}})", R"({"thread": {"0": {"histogram": {}}}})",
          R"({"thread": {"0": {"histogram": {"x": 1}}}})",
          R"({"thread": {"0": {"histogram": {"1": -1}}}})",
          R"({"thread": {"0": {"histogram": {"1": "many"}}}})"})
      CHECK_FALSE(parse_cyclictest(text));
  }
}

} // namespace cyclictest_test
