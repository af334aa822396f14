#include "flock/flock_parser.hpp"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"
#include "support/parser_laws.hpp"

namespace flock_parser_test {

using namespace nendo;
using namespace nendo::driver::flock;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;
using Outcome = test::Outcome<Record>;

/// A record as published: values of 14 bits in two bytes of seven, low one first; the turn is about
/// x by 90 degrees.
Bytes record_of(int x, int address = 1, int y = -5, int z = 8191) {
  Bytes bytes;
  for (const int value : {x, y, z, 5793, 5793, 0, 0}) {
    bytes.push_back(static_cast<std::byte>(value & 0x7F));
    bytes.push_back(static_cast<std::byte>((value >> 7) & 0x7F));
  }
  bytes.front() |= std::byte{0x80};
  bytes.push_back(static_cast<std::byte>(address));
  return bytes;
}

Outcome parse(std::span<const std::byte> input) {
  Outcome outcome = test::parse<Record>(Parser(), input, 15);
  CHECK(outcome.counters.record_bytes == 15 * outcome.counters.records);
  return outcome;
}

std::vector<int> xs_of(const Bytes& stream) {
  std::vector<int> xs;
  for (const Record& record : parse(stream).records)
    xs.push_back(record.position[0] / 4);
  return xs;
}

using Xs = std::vector<int>;

} // namespace

TEST_SUITE("flock_parser") {
  TEST_CASE("empty input yields no record of a bird") {
    CHECK(xs_of({}).empty());
  }

  TEST_CASE("a good record of a bird is delivered as it was sent") {
    const Outcome outcome = parse(record_of(-8192, 14));
    REQUIRE(outcome.records.size() == 1);
    const Record& record = outcome.records.front();
    CHECK(record.station == 14);
    CHECK(record.position == std::array<std::int16_t, 3>{-32768, -20, 32764});
    CHECK(record.quaternion == std::array<std::int16_t, 4>{23172, 23172, 0, 0});
  }

  TEST_CASE("two records of birds in a row are two") {
    CHECK(xs_of(joined({record_of(7, 1), record_of(-9, 2)})) == Xs{7, -9});
  }

  TEST_CASE("garbage before a bird's record is dropped and costs no record") {
    for (const Bytes& garbage :
         {bytes_of({1, 2, 3}), bytes_of({0x80}), bytes_of({0x80, 0xFF, 5})}) {
      const Outcome outcome = parse(joined({garbage, record_of(7)}));
      CHECK(outcome.records.size() == 1);
      CHECK(outcome.counters.discarded_bytes == garbage.size());
      CHECK(outcome.counters.bad_records == 0);
    }
  }

  TEST_CASE("a truncated record of a bird is held, and dropped when the next one begins") {
    Bytes half = record_of(3);
    half.resize(8);
    CHECK(parse(half).pending == 8);
    const Outcome outcome = parse(joined({record_of(1), half, record_of(4), record_of(5)}));
    CHECK(outcome.records.size() == 3);
    CHECK(outcome.counters.bad_records == 1);
    CHECK(outcome.counters.discarded_bytes == 8);
  }

  TEST_CASE("what is too much of a bird's record is dropped and counted once") {
    const Outcome outcome = parse(joined({record_of(1), bytes_of({1, 2, 3}), record_of(4)}));
    CHECK(outcome.records.size() == 2);
    CHECK(outcome.counters.bad_records == 1);
    CHECK(outcome.counters.discarded_bytes == 3);
  }

  TEST_CASE("a wrong bit 7, address or norm costs one record of a bird") {
    struct Case {
      std::size_t at;
      std::uint8_t flip;
    };
    for (const Case& c : {Case{0, 0x80}, Case{5, 0x80}, Case{14, 0x81}, Case{14, 0x1E},
                          Case{14, 0x01}, Case{7, 0x08}, Case{13, 0x10}}) {
      CAPTURE(c.at);
      Bytes bad = record_of(3);
      bad[c.at] ^= std::byte{c.flip};
      const Outcome outcome = parse(joined({record_of(1), bad, record_of(4), record_of(5)}));
      CHECK(outcome.records.size() == 3);
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 15);
    }
  }

  TEST_CASE("where a Flock's stream is cut makes no difference") {
    Bytes bad = record_of(3);
    bad[6] |= std::byte{0x80};
    const Bytes stream = joined({bytes_of({7, 0x80, 9}), record_of(1), record_of(2, 2), bad,
                                 bytes_of({0x80, 0x80}), record_of(4), record_of(5)});
    const auto value_of = [](const Record& record) { return record.position[0] / 4; };
    CHECK(test::values_however_cut<Record>(Parser(), {stream, 15}, value_of) == Xs{1, 2, 4, 5});
  }

  TEST_CASE("every byte of a Flock's stream is accounted for, however it is mutilated") {
    std::mt19937 random(5);
    std::uint64_t records = 0;
    for (int round = 0; round < 400; ++round) {
      Bytes stream;
      for (int k = 0; k < 30; ++k)
        stream = joined({stream, record_of(static_cast<int>(random() % 8192), 1 + k % 14)});
      test::mutilate(stream, random() % 20, random);
      records += parse(stream).counters.records;
    }
    CHECK(records > 400 * 15); // the damage is local
  }

  TEST_CASE("after a reset a bird's unfinished record is discarded") {
    Parser parser;
    int records = 0;
    const auto count = [&](const Record&) { ++records; };
    Bytes half = record_of(3);
    half.resize(8);
    parser.push(half, count);
    parser.reset();
    parser.count_discarded(7);
    parser.push(record_of(4), count);
    CHECK(records == 1);
    CHECK(parser.counters().discarded_bytes == 8 + 7);
    CHECK(parser.counters().bad_records == 0);
  }

  TEST_CASE("a file of a Flock's records yields what was worked out for it by hand") {
    test::reads_as_expected<Record>(Parser(), {"flock_stream.bin", 15}, [](const Record& record) {
      std::string line = std::to_string(record.station);
      for (const std::int16_t value : record.position)
        line += " " + std::to_string(value);
      for (const std::int16_t value : record.quaternion)
        line += " " + std::to_string(value);
      return line;
    });
  }
}

} // namespace flock_parser_test
