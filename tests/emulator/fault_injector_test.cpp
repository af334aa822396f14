#include "line/fault_injector.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <span>
#include <string>

#include <doctest/doctest.h>

namespace fault_injector_test {

using namespace std::chrono_literals;
using namespace nendo::emulator;

TEST_SUITE("fault_injector") {
  namespace {
  using Wire = FaultInjector::Wire;

  FaultInjector injector(const std::vector<std::string>& faults, std::uint32_t seed = 1) {
    auto parsed = parse_faults(faults);
    REQUIRE(parsed);
    return {*parsed, seed};
  }

  // Numbered, so that each is distinct: S, ten digits that are never 0, NUL.
  constexpr std::size_t record_bytes = 12;
  Wire record(std::uint32_t number) {
    Wire bytes{std::byte{'S'}};
    for (int k = 0; k < 10; ++k, number /= 8)
      bytes.push_back(static_cast<std::byte>(0x30 + number % 8));
    bytes.push_back(std::byte{0});
    return bytes;
  }

  Wire pass(FaultInjector& faults, std::uint32_t records) {
    Wire wire;
    for (std::uint32_t n = 0; n < records; ++n)
      faults.pass(record(n), true, 0s, wire);
    return wire;
  }

  // How many of the records a reader finds that cuts at NUL.
  std::uint64_t intact(const Wire& wire, std::uint32_t records) {
    std::set<Wire> wanted;
    for (std::uint32_t n = 0; n < records; ++n)
      wanted.insert(record(n));
    std::uint64_t found = 0;
    for (auto begin = wire.begin(); begin != wire.end();) {
      auto end = std::find(begin, wire.end(), std::byte{0});
      if (end != wire.end()) ++end;
      found += wanted.erase(Wire(begin, end));
      begin = end;
    }
    return found;
  }
  } // namespace

  TEST_CASE("without faults every byte passes as it is") {
    FaultInjector none = injector({});
    Wire all;
    for (std::uint32_t n = 0; n < 100; ++n) {
      const Wire one = record(n);
      all.insert(all.end(), one.begin(), one.end());
    }
    CHECK(pass(none, 100) == all);
    CHECK(none.records() == 100);
    CHECK(none.records_faulted() == 0);
    CHECK_FALSE(none.next_due());
  }

  TEST_CASE("every record that is not called faulted arrives whole, whatever the faults") {
    constexpr std::uint32_t records = 5000;
    for (const std::vector<std::string>& faults :
         {std::vector<std::string>{"drop=0.5%"},
          {"flip=0.5%"},
          {"insert=0.5%"},
          {"lose=3%"},
          {"burst=3%"},
          {"drop=1%", "flip=1%", "insert=1%", "lose=5%", "burst=5%"}}) {
      CAPTURE(faults[0]);
      for (std::uint32_t seed = 1; seed <= 3; ++seed) {
        FaultInjector noisy = injector(faults, seed);
        const std::uint64_t found = intact(pass(noisy, records), records);
        CHECK(noisy.records() == records);
        CHECK(noisy.records_faulted() > 0);
        CHECK(found >= records - noisy.records_faulted());
        CHECK(found <
              records + (faults[0].starts_with("insert") || faults[0].starts_with("burst")));
      }
    }
  }

  TEST_CASE("a fault happens as often as its rate says, and is counted each time") {
    constexpr std::uint32_t records = 20000;
    constexpr double bytes = records * static_cast<double>(record_bytes);
    const auto near = [](std::uint64_t count, double expected) {
      return std::abs(static_cast<double>(count) - expected) < 5.0 * std::sqrt(expected);
    };
    FaultInjector drop = injector({"drop=1%"});
    const Wire dropped = pass(drop, records);
    CHECK(near(drop.done(FaultKind::drop), bytes * 0.01));
    CHECK(dropped.size() == record_bytes * records - drop.done(FaultKind::drop));
    FaultInjector insert = injector({"insert=1%"});
    const std::size_t longer = pass(insert, records).size();
    CHECK(longer == record_bytes * records + insert.done(FaultKind::insert));
    CHECK(near(insert.done(FaultKind::insert), bytes * 0.01));
    FaultInjector lose = injector({"lose=2%"});
    const std::size_t shorter = pass(lose, records).size();
    CHECK(shorter == record_bytes * (records - lose.done(FaultKind::lose)));
    CHECK(near(lose.done(FaultKind::lose), records * 0.02));
    CHECK(lose.records_faulted() == lose.done(FaultKind::lose));
    FaultInjector all = injector({"lose=100%"});
    CHECK(pass(all, records).empty());
    FaultInjector flip = injector({"flip=1%"});
    const Wire flipped = pass(flip, records);
    REQUIRE(flipped.size() == record_bytes * records);
    std::uint64_t bits = 0;
    for (std::uint32_t n = 0; n < records; ++n) {
      const Wire good = record(n);
      for (std::size_t k = 0; k < record_bytes; ++k) {
        for (auto rest = std::to_integer<unsigned>(good[k] ^ flipped[n * record_bytes + k]);
             rest != 0; rest &= rest - 1) {
          ++bits;
        }
      }
    }
    CHECK(bits == flip.done(FaultKind::flip));
    CHECK(near(bits, bytes * 0.01));
  }

  TEST_CASE("one seed gives the same bytes every time, another one others") {
    const std::vector<std::string> faults{"drop=1%", "burst=1%"};
    FaultInjector one = injector(faults, 7);
    FaultInjector same = injector(faults, 7);
    FaultInjector other = injector(faults, 8);
    const Wire wire = pass(one, 500);
    CHECK(pass(same, 500) == wire);
    CHECK_FALSE(pass(other, 500) == wire);
  }

  TEST_CASE("whole-record faults spare replies, byte faults do not") {
    FaultInjector records_only = injector({"lose=100%", "burst=100%"});
    Wire wire;
    records_only.pass(record(1), false, 0s, wire);
    CHECK(wire == record(1));
    FaultInjector bytes = injector({"drop=100%"});
    wire.clear();
    bytes.pass(record(1), false, 0s, wire);
    CHECK(wire.empty());
    CHECK(bytes.records_faulted() == 0);
  }

  TEST_CASE("silence swallows what is sent while it lasts") {
    FaultInjector faults = injector({"silence@5s+3s"});
    std::size_t arrived = 0;
    for (auto now = 0s; now < 10s; now += 1s) {
      Wire wire;
      faults.pass(record(1), true, now, wire);
      if (!wire.empty()) ++arrived;
      CHECK(wire.empty() == (now >= 5s && now < 8s));
    }
    CHECK(arrived == 7);
    CHECK(faults.records_faulted() == 3);
  }

  TEST_CASE("events come once each, in the order of their times, and are counted as they begin") {
    FaultInjector faults =
        injector({"restart@9s", "eg@2s+3s", "swap@4s=18", "unplug@1s+1s", "drop=1%"});
    CHECK(faults.next_due() == FaultInjector::Time(1s));
    CHECK_FALSE(faults.next_event(999ms));
    std::string order;
    for (auto event = faults.next_event(20s); event; event = faults.next_event(20s))
      order += std::string(name_of(event->fault.kind)) + (event->over ? " over, " : ", ");
    CHECK(order == "unplug, eg, swap, swap over, eg over, restart, ");
    CHECK(faults.done(FaultKind::eg) == 1);
    CHECK(faults.done(FaultKind::swap) == 1);
    CHECK_FALSE(faults.next_due());
  }

  TEST_CASE("a record behind a modem probe's junk is called faulted") {
    FaultInjector faults = injector({});
    Wire wire;
    faults.pass_junk(wire);
    CHECK(wire.size() == 25);
    faults.pass(record(1), true, 0s, wire);
    faults.pass(record(2), true, 0s, wire);
    CHECK(faults.records_faulted() == 1);
    CHECK(intact(wire, 3) == 1);
  }
}

} // namespace fault_injector_test
