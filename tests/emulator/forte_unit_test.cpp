#include "units/forte_unit.hpp"

#include <chrono>

#include <doctest/doctest.h>

#include "support/unit_bench.hpp"

namespace forte_unit_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::emulator;
using nendo::test::Bytes;
using Bench = nendo::test::AdvancedBench<ForteUnit, ForteUnitOptions>;

namespace {

const Bytes data_on{0xB0, 0x73, 0x01};
const Bytes to_usb{0xB0, 0x76, 0x01};
const Bytes to_bluetooth{0xB0, 0x76, 0x02};

ForteUnitOptions at_100_hz(bool bluetooth = false) {
  ForteUnitOptions options;
  options.rate_hz = 100.0;
  options.bluetooth = bluetooth;
  return options;
}

} // namespace

TEST_SUITE("forte_unit") {
  TEST_CASE("it sends nothing before the commands to send and where to") {
    for (const bool bluetooth : {false, true}) {
      CAPTURE(bluetooth);
      const Bytes& right = bluetooth ? to_bluetooth : to_usb;
      const Bytes& wrong = bluetooth ? to_usb : to_bluetooth;
      Bench bench(at_100_hz(bluetooth));
      bench.send({0x01, 0xB0, 0x73, 0x02, 'A', 'T', '\r'});
      bench.send(right);
      CHECK(bench.after(1s).empty());
      CHECK_FALSE(bench.unit.next_due());
      bench.send(data_on);
      CHECK(bench.after(10ms).size() == 15 + 16);
      bench.send(wrong);
      CHECK(bench.after(1s).empty());
      bench.send(right);
      CHECK(bench.unit.next_due() == bench.now + 10ms);
      CHECK(bench.after(10ms).size() == 15 + 16);
    }
  }

  TEST_CASE("a command may arrive in pieces") {
    Bench bench(at_100_hz());
    for (const Bytes& command : {data_on, to_usb}) {
      for (const std::uint8_t byte : command)
        bench.send({byte});
    }
    CHECK_FALSE(bench.after(10ms).empty());
  }

  TEST_CASE("a record has its frame, counts of seven bits and a frame of motion behind it") {
    Bench bench(at_100_hz());
    bench.send(data_on);
    bench.send(to_usb);
    bool moves = false;
    Bytes before;
    for (int k = 0; k < 300; ++k) {
      const Bytes bytes = bench.after(10ms);
      REQUIRE(bytes.size() == 31);
      CHECK(Bytes(bytes.begin(), bytes.begin() + 3) == Bytes{0xF0, 0x01, 0x0B});
      for (std::size_t at = 3; at < 14; ++at)
        CHECK(bytes[at] <= 0x7F);
      CHECK(bytes[14] == 0xF7);
      CHECK(Bytes(bytes.begin() + 15, bytes.begin() + 18) == Bytes{0xF0, 0x02, 0x0C});
      CHECK(bytes[30] == 0xF7);
      moves = moves || (!before.empty() && bytes != before);
      before = bytes;
    }
    CHECK(moves);
    CHECK(bench.unit.counters().records == 300);
  }

  TEST_CASE("frames that the host does not take are refused and counted") {
    Bench bench(at_100_hz());
    bench.send(data_on);
    bench.send(to_usb);
    const std::uint64_t sent = bench.after(1h).size();
    CHECK(sent <= EmulatedUnit::output_capacity);
    CHECK(sent > EmulatedUnit::output_capacity - 16);
    CHECK(sent + bench.unit.counters().bytes_refused == 360'000ULL * 31);
  }
}

} // namespace forte_unit_test
