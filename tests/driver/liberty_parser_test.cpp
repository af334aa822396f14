#include "liberty/liberty_parser.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"
#include "support/parser_laws.hpp"

namespace liberty_parser_test {

using namespace nendo;
using namespace nendo::driver::liberty;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;
using Outcome = test::Outcome<Record>;

template <class Number>
Bytes sent(Number number) { // this machine stores the low byte first
  Bytes bytes(sizeof number);
  std::memcpy(bytes.data(), &number, sizeof number);
  return bytes;
}

/// A record of the published layout, of which `x_cm` is the number.
Bytes record_of(float x_cm, int station = 1, int length = 42, float w = 1) {
  return joined({bytes_of({'P', 'A', station, 'C', ' ', 0, length, 0}), sent(7000U), sent(9U),
                 sent(-3), sent(x_cm), sent(20.0F), sent(-30.0F), sent(w), sent(0.0F), sent(0.0F),
                 sent(0.0F), bytes_of("\r\n")});
}

int x_of(const Record& record) {
  return static_cast<int>(std::lround(record.position_m[0] * 100.0));
}

using Values = std::vector<int>;

Values values_of(const Outcome& outcome) {
  Values values;
  for (const Record& record : outcome.records)
    values.push_back(x_of(record));
  return values;
}

Outcome parse(std::span<const std::byte> input) {
  return test::parse<Record>(Parser(), input, 50);
}

} // namespace

TEST_SUITE("liberty_parser") {
  TEST_CASE("empty input yields no pose of a LIBERTY") {
    CHECK(parse({}).records.empty());
  }

  TEST_CASE("a good LIBERTY record is delivered with its time, frame and distortion") {
    for (const int length : {42, 50}) { // without and with the header
      const Outcome outcome = parse(record_of(12.5F, 2, length));
      REQUIRE(outcome.records.size() == 1);
      const Record& record = outcome.records[0];
      CHECK(models[record.model].name == "PATRIOT");
      CHECK(record.station == 2);
      CHECK(record.error == ' ');
      CHECK(record.time_ms == 7000);
      CHECK(record.frame == 9);
      CHECK(record.distortion == -3);
      CHECK(record.position_m[0] == doctest::Approx(0.125));
      CHECK(record.position_m[2] == doctest::Approx(-0.3));
      CHECK(record.turn_xyzw == std::array{0.0, 0.0, 0.0, 1.0});
    }
  }

  TEST_CASE("two LIBERTY records in a row are two, after any garbage") {
    for (const Bytes& garbage : {Bytes{}, bytes_of("PAPALYLU"), bytes_of({'P', 'A', 1, 'C'}),
                                 bytes_of({'L', 'Y', 1, 'C', ' ', 0, 42, 0, 1, 2, 3})}) {
      const Outcome outcome = parse(joined({garbage, record_of(9), record_of(50)}));
      CHECK(values_of(outcome) == Values{9, 50});
      CHECK(outcome.counters.discarded_bytes == garbage.size());
      CHECK(outcome.counters.bad_records == 0);
    }
  }

  TEST_CASE("a truncated or over-long LIBERTY record is dropped alone") {
    for (std::size_t length = 1; length < 50; ++length) {
      CAPTURE(length);
      Bytes half = record_of(9);
      half.resize(length);
      CHECK(parse(half).pending == length);
      const Outcome outcome = parse(joined({record_of(1), half, record_of(50)}));
      CHECK(values_of(outcome) == Values{1, 50});
      CHECK(outcome.counters.bad_records == 1);
      Bytes longer = record_of(9);
      longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(length), std::byte{7});
      CHECK(values_of(parse(joined({record_of(1), longer, record_of(50)}))) == Values{1, 50});
    }
  }

  TEST_CASE("a LIBERTY record with a bad header, end or pose is dropped alone") {
    struct Damage {
      std::size_t at;
      int to;
    };
    for (const Damage& damage : {Damage{0, 'Q'}, Damage{1, 'Y'}, Damage{2, 0}, Damage{2, 17},
                                 Damage{3, 'X'}, Damage{6, 43}, Damage{7, 1}, Damage{48, ' '},
                                 Damage{49, ' '}, Damage{23, 0x7F}, Damage{35, 0x40}}) {
      CAPTURE(damage.at);
      Bytes bad = record_of(9);
      bad[damage.at] = static_cast<std::byte>(damage.to);
      const Outcome outcome = parse(joined({record_of(1), bad, record_of(50)}));
      CHECK(values_of(outcome) == Values{1, 50});
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 50);
    }
    CHECK(parse(record_of(std::numeric_limits<float>::quiet_NaN())).records.empty());
    CHECK(parse(record_of(501)).records.empty());
  }

  TEST_CASE("records without distortion are read when they are expected") {
    Bytes record = record_of(9, 1, 38);
    record.erase(record.begin() + 16, record.begin() + 20);
    Parser parser;
    parser.reset(short_bytes);
    Values values;
    parser.push(joined({record, record}), [&](const Record& read) {
      values.push_back(x_of(read));
      CHECK(read.distortion == 0);
    });
    CHECK(values == Values{9, 9});
    CHECK(parse(joined({record, record})).records.empty());
  }

  TEST_CASE("where a LIBERTY stream is cut makes no difference") {
    Bytes lost = record_of(3);
    lost.erase(lost.begin() + 20);
    const Bytes stream = joined({bytes_of("LPA"), record_of(1), lost, record_of(2),
                                 bytes_of({'P', 'A', 0, 0x15}), record_of(4), bytes_of("LY")});
    CHECK(test::values_however_cut<Record>(Parser(), {stream, 50}, x_of) == Values{1, 2, 4});
  }

  TEST_CASE("every byte of a LIBERTY stream is accounted for, however it is mutilated") {
    std::mt19937 random(5);
    std::uint64_t records = 0;
    for (int round = 0; round < 400; ++round) {
      Bytes stream;
      for (int k = 0; k < 30; ++k) {
        const Bytes next = record_of(static_cast<float>(random() % 400), 1 + k % 2);
        stream.insert(stream.end(), next.begin(), next.end());
      }
      const auto damages = random() % 10;
      test::mutilate(stream, damages, random);
      const std::uint64_t here = parse(stream).counters.records;
      CHECK(here + damages >= 30); // each costs one record at most
      records += here;
    }
    CHECK(records > 400 * 20);
  }

  TEST_CASE("a file of LIBERTY's records yields what was worked out for it by hand") {
    test::reads_as_expected<Record>(Parser(), {"liberty_stream.bin", 50}, [](const Record& record) {
      return test::pose_line(record) + "  " + std::string(models[record.model].name) + " " +
             std::to_string(record.time_ms) + " " + std::to_string(record.frame) + " " +
             std::to_string(record.distortion);
    });
  }
}

} // namespace liberty_parser_test
