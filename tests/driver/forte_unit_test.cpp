#include "units/forte_unit.hpp"

#include <chrono>
#include <vector>

#include <doctest/doctest.h>

namespace forte_unit_test {

using namespace std::chrono_literals;
using namespace nendo;
using namespace nendo::emulator;

namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes data_on{0xB0, 0x73, 0x01};
const Bytes to_usb{0xB0, 0x76, 0x01};
const Bytes to_bluetooth{0xB0, 0x76, 0x02};

struct Bench {
  explicit Bench(const ForteUnitOptions& options = {}) : unit(options) { unit.advance(now); }

  Bytes after(EmulatedUnit::Time time) {
    unit.advance(now += time);
    const auto output = unit.output();
    Bytes bytes;
    for (const std::byte byte : output)
      bytes.push_back(std::to_integer<std::uint8_t>(byte));
    unit.take(output.size());
    return bytes;
  }
  void tell(const Bytes& bytes) { unit.receive(std::as_bytes(std::span(bytes)), now); }

  ForteUnit unit;
  EmulatedUnit::Time now = 1h; // not 0: a unit has usually been on for a while
};

ForteUnitOptions at_100_hz(bool bluetooth = false) {
  ForteUnitOptions options;
  options.rate_hz = 100.0;
  options.bluetooth = bluetooth;
  return options;
}

} // namespace

TEST_SUITE("forte_unit") {
  TEST_CASE("it sends nothing until it was told both to send and where to") {
    for (const bool bluetooth : {false, true}) {
      CAPTURE(bluetooth);
      const Bytes& right = bluetooth ? to_bluetooth : to_usb;
      const Bytes& wrong = bluetooth ? to_usb : to_bluetooth;
      Bench bench(at_100_hz(bluetooth));
      bench.tell({0x01, 0xB0, 0x73, 0x02, 'A', 'T', '\r'});
      bench.tell(right);
      CHECK(bench.after(1s).empty());
      CHECK_FALSE(bench.unit.next_due());
      bench.tell(data_on);
      CHECK(bench.after(10ms).size() == 15 + 16);
      bench.tell(wrong);
      CHECK(bench.after(1s).empty());
      bench.tell(right);
      CHECK(bench.unit.next_due() == bench.now + 10ms);
      CHECK(bench.after(10ms).size() == 15 + 16);
    }
  }

  TEST_CASE("a command may arrive in pieces") {
    Bench bench(at_100_hz());
    for (const Bytes& command : {data_on, to_usb}) {
      for (const std::uint8_t byte : command)
        bench.tell({byte});
    }
    CHECK_FALSE(bench.after(10ms).empty());
  }

  TEST_CASE("a record has its frame, counts of seven bits and a frame of motion behind it") {
    Bench bench(at_100_hz());
    bench.tell(data_on);
    bench.tell(to_usb);
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

  TEST_CASE("what the host does not take is refused and counted") {
    Bench bench(at_100_hz());
    bench.tell(data_on);
    bench.tell(to_usb);
    const std::uint64_t sent = bench.after(1h).size();
    CHECK(sent <= EmulatedUnit::output_capacity);
    CHECK(sent > EmulatedUnit::output_capacity - 16);
    CHECK(sent + bench.unit.counters().bytes_refused == 360'000ULL * 31);
  }
}

} // namespace forte_unit_test
