#include "units/lucidgloves_unit.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
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

namespace {

LucidGlovesUnitOptions with(LucidGlovesFirmware firmware) {
  LucidGlovesUnitOptions options;
  options.firmware = firmware;
  return options;
}

std::size_t lines_in(const nendo::test::Bytes& bytes) {
  return static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), '\n'));
}

} // namespace

TEST_SUITE("lucidgloves_unit") {
  TEST_CASE(
      "it sends its number of lines per second by itself, with every key that the firmware sends") {
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

  TEST_CASE("it says who it is, and stops and starts by command") {
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

  TEST_CASE("a firmware without force feedback streams on after any command") {
    Bench bench(with(LucidGlovesFirmware::streaming));
    for (const char* command : {"A900B900C900D900E900\n", "Z\n", "(ZZ)\n"})
      CHECK(bench.ask(command).empty());
    CHECK(bench.unit.brakes() == std::array{0, 0, 0, 0, 0});
    CHECK(lines_in(bench.after(20ms)) == 2);
  }

  TEST_CASE("a waiting firmware sends a line per second to a host that says nothing") {
    Bench bench(with(LucidGlovesFirmware::waiting));
    std::size_t lines = 0;
    for (int k = 0; k < 1000; ++k)
      lines += lines_in(bench.after(10ms));
    CHECK(lines == 10);
    CHECK(bench.unit.counters().records == lines);
  }

  TEST_CASE("a waiting firmware sends its next line soon after it heard one, and no earlier") {
    Bench bench(with(LucidGlovesFirmware::waiting));
    CHECK(lines_in(bench.after(1ms)) == 1);
    for (const char* command : {"\n", "Z\n", "A1B2C3D4E5\n", "whatever\n"}) {
      CHECK(bench.after(5ms).empty());
      CHECK(bench.ask(command).empty());
      CHECK(lines_in(bench.after(1ms)) == 1);
    }
    CHECK(bench.unit.brakes() == std::array{1, 2, 3, 4, 5});
    std::size_t lines = 0;
    for (int k = 0; k < 1000; ++k) {
      bench.send({'\n'});
      lines += lines_in(bench.after(1ms));
    }
    CHECK(lines == 1000);
    CHECK(bench.unit.brakes() == std::array{1, 2, 3, 4, 5}); // an empty line sets none
  }

  TEST_CASE("lines that a waiting firmware has not read yet are read one a loop") {
    Bench bench(with(LucidGlovesFirmware::waiting));
    bench.after(1ms);
    CHECK(bench.ask("\nA9B9C9D9E9\n\n").empty());
    CHECK(bench.unit.brakes() == std::array{0, 0, 0, 0, 0});
    CHECK(lines_in(bench.after(1ms)) == 1);
    CHECK(bench.unit.brakes() == std::array{9, 9, 9, 9, 9});
    CHECK(lines_in(bench.after(10ms)) == 2);
    CHECK(bench.after(900ms).empty());
  }

  TEST_CASE("a waiting firmware takes half a line for a whole one after a second") {
    Bench bench(with(LucidGlovesFirmware::waiting));
    bench.after(1ms);
    bench.after(700ms);
    CHECK(bench.ask("A1B2C").empty());
    CHECK(bench.after(999ms).empty()); // the time limit restarts with each byte
    CHECK(bench.unit.brakes() == std::array{0, 0, 0, 0, 0});
    CHECK(lines_in(bench.after(2ms)) == 1);
    CHECK(bench.unit.brakes() == std::array{1, 2, 0, 0, 0});
  }

  TEST_CASE("a waiting firmware ignores lines of less than five characters") {
    Bench bench(with(LucidGlovesFirmware::waiting));
    bench.after(1ms);
    bench.ask("A900B900C900D900E900\n");
    for (const char* command : {"(ZA)\n", "Z\n", "\n", "A1\n"}) {
      bench.after(1ms);
      bench.ask(command);
      CHECK(bench.unit.brakes() == std::array{900, 900, 900, 900, 900});
    }
  }

  TEST_CASE("a legacy firmware sends 13 numbers, and takes whatever it hears for brakes") {
    Bench bench(with(LucidGlovesFirmware::legacy));
    std::istringstream line(text_of(bench.after(10ms)));
    for (int k = 0; k < 13; ++k) {
      CAPTURE(k);
      int value = -1;
      CHECK((line >> value));
      CHECK(value >= 0);
      CHECK(value <= 4095);
      CHECK(line.get() == (k < 12 ? '&' : '\n'));
    }
    CHECK(bench.unit.brakes() == std::array{0, 0, 0, 0, 0});
    bench.ask("1&2&3&4&5\n");
    CHECK(bench.unit.brakes() == std::array{1, 2, 3, 4, 5});
    bench.ask("\n");
    CHECK(bench.unit.brakes() == std::array{1, 2, 3, 4, 5});
    bench.ask("Z\n");
    CHECK(bench.unit.brakes() == std::array{0, 1000, 1000, 1000, 1000});
  }

  TEST_CASE(
      "a legacy firmware with force feedback waits for a line, and an empty one sets nothing") {
    Bench bench(with(LucidGlovesFirmware::legacy_waiting));
    CHECK(lines_in(bench.after(1ms)) == 1);
    CHECK(lines_in(bench.after(4900ms)) == 0);
    CHECK(lines_in(bench.after(200ms)) == 1);
    std::size_t lines = 0;
    for (int k = 0; k < 100; ++k) {
      lines += lines_in(bench.ask("\n"));
      lines += lines_in(bench.after(1ms));
    }
    CHECK(lines >= 99);
    CHECK(bench.unit.brakes() == std::array{0, 0, 0, 0, 0});
  }

  TEST_CASE("an unclamped firmware goes beyond its range at both ends") {
    for (const auto firmware :
         {LucidGlovesFirmware::unclamped, LucidGlovesFirmware::legacy_unclamped}) {
      LucidGlovesUnitOptions options = with(firmware);
      options.motion = driver::Motion::grasp;
      Bench bench(options);
      int least = 0;
      int greatest = 0;
      for (int k = 0; k < 1000; ++k) {
        std::istringstream text(text_of(bench.after(10ms)));
        for (char c = 0; text.get(c);) {
          if (c != '-' && (c < '0' || c > '9')) continue;
          text.unget();
          int value = 0;
          if (!(text >> value)) break;
          least = std::min(least, value);
          greatest = std::max(greatest, value);
        }
      }
      CHECK(least < 0);
      CHECK(greatest > 4095);
    }
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
