#include "units/lucidgloves_unit.hpp"

#include <chrono>
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include "support/unit_bench.hpp"

namespace lucidgloves_unit_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::emulator;
using nendo::test::text_of;
using Bench = nendo::test::AdvancedBench<LucidGlovesUnit, LucidGlovesUnitOptions>;

TEST_SUITE("lucidgloves_unit") {
  TEST_CASE("it sends so many lines a second by itself, with every key that the firmware sends") {
    Bench bench;
    std::size_t lines = 0;
    for (int k = 0; k < 100; ++k) {
      std::istringstream text(text_of(bench.after(10ms)));
      for (std::string line; std::getline(text, line); ++lines) {
        CHECK(line.size() < 82);
        std::size_t at = 0;
        for (const char* key :
             {"A", "B", "C", "D", "E", "F", "G", "P", "(AB)", "(BB)", "(CB)", "(DB)", "(EB)"}) {
          CAPTURE(line);
          at = line.find(key, at);
          REQUIRE(at != std::string::npos);
          at += std::string_view(key).size();
          const int value = std::stoi(line.substr(at));
          CHECK(value >= 0);
          CHECK(value <= 4095);
        }
      }
    }
    CHECK(lines == 100);
    CHECK(bench.unit.counters().records == 100);
  }

  TEST_CASE("it says who it is, and stops and starts when it is told to") {
    LucidGlovesUnitOptions options;
    options.side = Side::left;
    Bench bench(options);
    CHECK(text_of(bench.ask("Z\n")) == "(ZV)5(ZG)0(ZH)0\n");
    CHECK(bench.ask("(ZZ)\n").empty());
    CHECK_FALSE(bench.unit.next_due());
    CHECK(bench.after(1s).empty());
    CHECK(bench.ask("(ZA)\n").empty());
    CHECK_FALSE(bench.after(20ms).empty());
  }

  TEST_CASE("a firmware that knows no questions streams on and frees the thumb at most") {
    LucidGlovesUnitOptions options;
    options.answers = false;
    Bench bench(options);
    bench.ask("A900B900C900D900E900\n");
    CHECK(bench.ask("Z\n").empty());
    CHECK(bench.unit.brakes() == std::array{900, 900, 900, 900, 900});
    CHECK(bench.ask("(ZZ)\n").empty());
    CHECK_FALSE(bench.after(20ms).empty());
    bench.ask("(ZA)\n");
    CHECK(bench.unit.brakes() == std::array{0, 900, 900, 900, 900});
  }

  TEST_CASE("brakes handle whole lines, cut anywhere, and never go past locked") {
    Bench bench;
    bench.ask("A1B2C3");
    CHECK(bench.unit.brakes() == std::array{0, 0, 0, 0, 0});
    bench.ask("D4E5\n");
    CHECK(bench.unit.brakes() == std::array{1, 2, 3, 4, 5});
    bench.ask("C5000\n");
    CHECK(bench.unit.brakes() == std::array{1, 2, 1000, 4, 5});
    bench.ask(std::string(10'000, 'A') + "1\n");
    CHECK(bench.unit.brakes() == std::array{0, 2, 1000, 4, 5});
  }

  TEST_CASE("what the host does not take is refused whole and counted, however long that lasts") {
    Bench bench;
    const std::string text = text_of(bench.after(1h));
    CHECK(text.size() <= EmulatedUnit::output_capacity);
    CHECK(text.back() == '\n');
    const auto counters = bench.unit.counters();
    CHECK(counters.records <= EmulatedUnit::output_capacity / 70);
    CHECK(counters.bytes_refused > 300'000u * 20);
  }
}

} // namespace lucidgloves_unit_test
