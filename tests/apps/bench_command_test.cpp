#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/program.hpp"

using nendo::test::is_one_line_about;
using nendo::test::lines_of;

TEST_SUITE("bench") {
  TEST_CASE("bench driver tells both latencies and their ratio, on a terminal and on sockets") {
    const auto done = nendo::test::nendo({"bench", "driver", "--records", "40", "--json"});
    REQUIRE(done.exit_code == 0);
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 2);
    for (const auto& line : lines) {
      const auto measured = nlohmann::json::parse(line);
      for (const std::string who : {"driver_us", "bare_us"}) {
        CHECK(measured[who]["records"] == 40);
        CHECK(measured[who]["min"].get<double>() > 1.0);
        CHECK(measured[who]["p99"].get<double>() >= measured[who]["p50"].get<double>());
        CHECK(measured[who]["max"].get<double>() >= measured[who]["p99"].get<double>());
      }
      const double ratio =
          measured["driver_us"]["p50"].get<double>() / measured["bare_us"]["p50"].get<double>();
      CHECK(measured["ratio"]["p50"].get<double>() == doctest::Approx(ratio));
    }
  }

  TEST_CASE("bench says what cannot be measured") {
    const auto rate = nendo::test::nendo({"bench", "driver", "--rate", "1000"});
    CHECK(rate.exit_code == 2);
    CHECK(is_one_line_about(rate.err, "480"));
    const auto none = nendo::test::nendo({"bench", "driver", "--records", "0"});
    CHECK(none.exit_code == 2);
    CHECK(is_one_line_about(none.err, "--records"));
  }
}
