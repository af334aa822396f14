#include "units/fivedt_unit.hpp"

#include <chrono>
#include <utility>

#include <doctest/doctest.h>

#include "support/unit_bench.hpp"

namespace fivedt_unit_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::emulator;
using nendo::test::Bytes;
using Bench = nendo::test::AdvancedBench<FiveDtUnit, FiveDtUnitOptions>;

namespace {

void check_sample(const Bytes& bytes) {
  REQUIRE(bytes.size() >= 9);
  CHECK(bytes[0] == 0x80);
  CHECK((bytes[1] ^ bytes[2] ^ bytes[3] ^ bytes[4] ^ bytes[5] ^ bytes[6] ^ bytes[7]) == bytes[8]);
}

} // namespace

TEST_SUITE("fivedt_unit") {
  TEST_CASE("it answers resets, questions and polls, and nothing else") {
    FiveDtUnitOptions options;
    options.side = Side::left;
    Bench bench(options);
    CHECK(bench.after(1s).empty());
    CHECK(bench.ask("A") == Bytes{0x55});
    const Bytes information = bench.ask("G");
    REQUIRE(information.size() == 32);
    CHECK(information[0] == 'B');
    CHECK(information[1] == 'R');
    CHECK((information[4] & 1) == 0);
    const Bytes sample = bench.ask("C");
    CHECK(sample.size() == 9);
    check_sample(sample);
    CHECK(bench.ask("xyz\r\n?").empty());
  }

  TEST_CASE("it streams from D to A") {
    Bench bench;
    CHECK(bench.ask("D").empty());
    std::size_t samples = 0;
    for (int k = 0; k < 50; ++k, ++samples) {
      const Bytes sample = bench.after(10ms);
      CHECK(sample.size() == 9);
      check_sample(sample);
    }
    CHECK(bench.unit.counters().records == samples);
    CHECK(bench.ask("A") == Bytes{0x55});
    CHECK(bench.after(1s).empty());
  }

  TEST_CASE("units of ten bytes send one more after each sample") {
    FiveDtUnitOptions options;
    options.ten_bytes = true;
    Bench wired(options);
    const Bytes sample = wired.ask("C");
    check_sample(sample);
    CHECK(sample.size() == 10);
    CHECK(sample.back() == 0x55);
  }

  TEST_CASE("a wireless one streams by itself and hears nothing") {
    for (const Side side : {Side::left, Side::right}) {
      FiveDtUnitOptions options;
      options.side = side;
      options.rate_hz = 90.0;
      options.wireless = true;
      Bench bench(options);
      CHECK(bench.ask("AGC").empty());
      const Bytes sample = bench.after(12ms);
      check_sample(sample);
      CHECK(sample.size() == 10);
      CHECK(sample.back() == (side == Side::right ? 0x01 : 0x40));
    }
  }

  TEST_CASE("a left glove's fingers are reversed if it is of that kind, a right one's never") {
    for (const Side side : {Side::left, Side::right}) {
      FiveDtUnitOptions options;
      options.side = side;
      Bench usual(options);
      options.left_little_first = true;
      Bench reversed(options);
      Bytes sample = usual.ask("C");
      const Bytes other = reversed.ask("C");
      check_sample(other);
      if (side == Side::left) {
        CHECK(sample != other);
        std::swap(sample[1], sample[5]);
        std::swap(sample[2], sample[4]);
      }
      CHECK(sample == other);
    }
  }

  TEST_CASE("samples that the host does not take are refused and counted") {
    Bench bench;
    bench.ask("D");
    CHECK(bench.after(1h).size() == EmulatedUnit::output_capacity / 9 * 9);
    CHECK(bench.unit.counters().bytes_refused == 9 * (360'000 - EmulatedUnit::output_capacity / 9));
  }
}

} // namespace fivedt_unit_test
