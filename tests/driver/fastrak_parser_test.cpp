#include "fastrak/fastrak_parser.hpp"

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

namespace fastrak_parser_test {

using namespace nendo;
using namespace nendo::driver::fastrak;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;
using Outcome = test::Outcome<Record>;

/// A record of the published layout, whose x in centimetres is `x_cm`.
Bytes record_of(float x_cm, char station = '1', char error = ' ',
                std::array<float, 4> wxyz = {1, 0, 0, 0}) {
  Bytes bytes = bytes_of({'0', station, error});
  for (const float number : {x_cm, 20.0F, -30.0F, wxyz[0], wxyz[1], wxyz[2], wxyz[3]}) {
    std::array<std::byte, 4> sent{}; // this machine stores the low byte first
    std::memcpy(sent.data(), &number, sizeof number);
    bytes.insert(bytes.end(), sent.begin(), sent.end());
  }
  return joined({bytes, bytes_of("\r\n")});
}

int value_of(const Record& record) {
  return static_cast<int>(std::lround(record.position_m[0] * 100.0));
}

using Values = std::vector<int>;

Values values_of(const Outcome& outcome) {
  Values values;
  for (const Record& record : outcome.records)
    values.push_back(value_of(record));
  return values;
}

Outcome parse(std::span<const std::byte> input, std::span<const std::uint16_t> stations = {}) {
  Parser parser;
  parser.expect(stations);
  Outcome outcome = test::parse<Record>(parser, input, 33);
  CHECK(outcome.counters.record_bytes == 33 * outcome.counters.records);
  return outcome;
}

} // namespace

TEST_SUITE("fastrak_parser") {
  TEST_CASE("empty input yields no pose") {
    CHECK(parse({}).records.empty());
  }

  TEST_CASE("a good FASTRAK record is delivered at once, in metres, with the scalar last") {
    const Outcome outcome = parse(record_of(12.5F, '3', 'k', {0.1F, 0.7F, -0.5F, 0.5F}));
    REQUIRE(outcome.records.size() == 1);
    const Record& record = outcome.records[0];
    CHECK(record.station == 3);
    CHECK(record.error == 'k');
    CHECK(record.position_m[0] == doctest::Approx(0.125));
    CHECK(record.position_m[1] == doctest::Approx(0.2));
    CHECK(record.position_m[2] == doctest::Approx(-0.3));
    CHECK(record.turn_xyzw[0] == doctest::Approx(0.7));
    CHECK(record.turn_xyzw[1] == doctest::Approx(-0.5));
    CHECK(record.turn_xyzw[2] == doctest::Approx(0.5));
    CHECK(record.turn_xyzw[3] == doctest::Approx(0.1));
    CHECK(outcome.pending == 0);
  }

  TEST_CASE("two FASTRAK records in a row are two") {
    const Outcome outcome = parse(joined({record_of(9), record_of(50, '2')}));
    CHECK(values_of(outcome) == Values{9, 50});
    CHECK(outcome.counters.discarded_bytes == 0);
  }

  TEST_CASE("garbage before the first FASTRAK record is discarded up to its line's end") {
    Bytes tail = record_of(3);
    tail.erase(tail.begin(), tail.begin() + 11);
    for (const Bytes& garbage :
         {tail, bytes_of("21l1100\r\n"), bytes_of("0000\r\r\n"), bytes_of("01 x\r\n\r\n")}) {
      const Outcome outcome = parse(joined({garbage, record_of(9), record_of(50)}));
      CHECK(values_of(outcome) == Values{9, 50});
      CHECK(outcome.counters.discarded_bytes == garbage.size());
      CHECK(outcome.counters.bad_records == 0);
    }
  }

  TEST_CASE("a truncated FASTRAK record is held back, and dropped alone when the next one comes") {
    for (std::size_t length = 1; length < 31; ++length) {
      CAPTURE(length);
      Bytes half = record_of(9);
      half.resize(length);
      CHECK(parse(half).pending == length);
      const Outcome outcome = parse(joined({record_of(1), half, record_of(5), record_of(50)}));
      CHECK(outcome.counters.bad_records == 1);
      CHECK(values_of(outcome) == Values{1, 50}); // the one after it has lost its place
    }
  }

  TEST_CASE("an over-long FASTRAK record is dropped alone and counts once") {
    for (const std::size_t surplus : {std::size_t{1}, std::size_t{2}, std::size_t{200}}) {
      CAPTURE(surplus);
      Bytes longer = record_of(9);
      longer.insert(longer.begin() + 10, surplus, std::byte{'0'});
      const Outcome outcome = parse(joined({record_of(1), longer, record_of(50)}));
      CHECK(values_of(outcome) == Values{1, 50});
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 33 + surplus);
    }
  }

  TEST_CASE("a FASTRAK record with a bad begin, station, letter or end costs two at most") {
    struct Damage {
      std::size_t at;
      int to;
      Values left;
    };
    for (const Damage& damage :
         {Damage{0, '1', {1, 50, 60}}, Damage{1, '0', {1, 50, 60}}, Damage{1, 'D', {1, 50, 60}},
          Damage{2, '1', {1, 50, 60}}, Damage{2, 0x80, {1, 50, 60}}, Damage{31, 0x0C, {1, 60}},
          Damage{32, 0x0B, {1, 60}}}) {
      CAPTURE(damage.at);
      CAPTURE(damage.to);
      Bytes bad = record_of(9);
      bad[damage.at] = static_cast<std::byte>(damage.to);
      const Outcome outcome = parse(joined({record_of(1), bad, record_of(50), record_of(60)}));
      CHECK(values_of(outcome) == damage.left);
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 33 * (4 - damage.left.size()));
    }
  }

  TEST_CASE("a FASTRAK record that is no pose is dropped alone") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    for (const Bytes& bad :
         {record_of(nan), record_of(infinity), record_of(501), record_of(-501),
          record_of(9, '1', ' ', {1, 0.1F, 0, 0}), record_of(9, '1', ' ', {0.997F, 0, 0, 0}),
          record_of(9, '1', ' ', {nan, 0, 0, 0}), record_of(9, '1', ' ', {0, 0, 0, 0})}) {
      const Outcome outcome = parse(joined({record_of(1), bad, record_of(50)}));
      CHECK(values_of(outcome) == Values{1, 50});
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 33);
    }
    CHECK(parse(record_of(500, '1', ' ', {0.9985F, 0, 0, 0})).records.size() == 1);
  }

  TEST_CASE("records of stations that are off are damage") {
    const std::array<std::uint16_t, 2> stations{1, 11};
    const Outcome outcome = parse(
        joined({record_of(1), record_of(2, '2'), record_of(3, 'B'), record_of(4, '3')}), stations);
    CHECK(values_of(outcome) == Values{1, 3});
    CHECK(outcome.records[1].station == 11);
    CHECK(outcome.counters.bad_records == 2);
  }

  TEST_CASE("numbers may contain the begin and the end of records") {
    // 0x0A0D0A0D and 0x0D300A0D are tiny floats, so they can be coordinates.
    Bytes tricky = record_of(9);
    const Bytes inner = bytes_of("\r\n\r\n\r\n01 ");
    std::copy(inner.begin(), inner.end(), tricky.begin() + 3);
    const Outcome outcome = parse(joined({record_of(1), tricky, record_of(50)}));
    CHECK(outcome.records.size() == 3);
    CHECK(outcome.counters.discarded_bytes == 0);
  }

  TEST_CASE("where a FASTRAK stream is cut makes no difference") {
    Bytes lost = record_of(3);
    lost.erase(lost.begin() + 20);
    Bytes no_end = record_of(4);
    no_end.erase(no_end.end() - 1);
    const Bytes stream = joined({bytes_of("\n01 \r"), record_of(1), record_of(2), lost,
                                 record_of(5), no_end, record_of(6), record_of(7, '2', 'k'),
                                 bytes_of("2 E*ERROR*\r\n"), record_of(8), bytes_of("01 0\r\n0")});
    CHECK(test::values_however_cut<Record>(Parser(), {stream, 33}, value_of) == Values{2, 5, 7, 8});
  }

  TEST_CASE("every byte of a FASTRAK stream is accounted for, however it is mutilated") {
    std::mt19937 random(5);
    std::uint64_t records = 0;
    for (int round = 0; round < 400; ++round) {
      Bytes stream;
      for (int k = 0; k < 30; ++k) {
        const Bytes next = record_of(static_cast<float>(random() % 400), k % 2 == 0 ? '1' : '2');
        stream.insert(stream.end(), next.begin(), next.end());
      }
      const auto damages = random() % 10;
      test::mutilate(stream, damages, random);
      const std::uint64_t here = parse(stream).counters.records;
      CHECK(here + 2 * damages >= 30); // each costs two records at most
      records += here;
    }
    CHECK(records > 400 * 20);
  }

  TEST_CASE("after a reset the unfinished FASTRAK record is discarded") {
    Parser parser;
    int records = 0;
    const auto count = [&](const Record&) { ++records; };
    const Bytes record = record_of(9);
    parser.push(std::span(record).first(5), count);
    parser.reset();
    parser.count_discarded(7);
    parser.push(std::span(record).subspan(5), count); // its end, which is no bad record
    parser.push(record_of(50), count);
    CHECK(records == 1);
    CHECK(parser.counters().discarded_bytes == 33 + 7);
    CHECK(parser.counters().bytes == 33 + 7 + 33);
    CHECK(parser.counters().bad_records == 0);
  }

  TEST_CASE("a file of FASTRAK records yields what was worked out for it by hand") {
    test::reads_as_expected<Record>(Parser(), {"fastrak_stream.bin", 33}, test::pose_line<Record>);
  }

  TEST_CASE("a status is found among other bytes, and InterSense's is one byte shorter") {
    const std::string status = "21S3F2    F32  02.03 FASTRAK 1.0                     \r\n";
    REQUIRE(status.size() == 55);
    const auto found = find_status("0212\r\n" + status);
    REQUIRE(found);
    CHECK(found->firmware == "02.03");
    CHECK(found->identification == "FASTRAK 1.0");
    CHECK(found->error.empty());
    CHECK(found->is_metric());
    CHECK_FALSE(found->is_intersense);
    CHECK_FALSE(find_status(status.substr(0, 54)));
    CHECK_FALSE(find_status("21Szzz" + status.substr(6)));
    std::string shorter = status;
    shorter.erase(40, 1);
    CHECK(find_status(shorter)->is_intersense);
    shorter.erase(40, 1);
    CHECK_FALSE(find_status(shorter));
  }

  TEST_CASE("the answers about stations and refused commands are read, and damaged ones are not") {
    CHECK(find_stations("noise 21l1010\r\n") == "1010");
    CHECK_FALSE(find_stations("21l1010"));
    CHECK_FALSE(find_stations("21l\r\n"));
    CHECK_FALSE(find_stations("2"));
    CHECK(find_refusals("2 E*ERROR*O9,2*ERROR* EC -3*PS 2*FL 1*ST 8\r\n") == "O9,2 (error -3)");
    CHECK(find_refusals("*ERROR*x\x1B[2J*ERROR*").find('\x1B') == std::string::npos);
    CHECK(find_refusals("*ERROR*").empty());
    for (char letter = 'A'; letter <= 'z'; ++letter)
      CHECK_FALSE(meaning_of_error(letter).empty());
  }
}

} // namespace fastrak_parser_test
