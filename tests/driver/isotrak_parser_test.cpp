#include "isotrak/isotrak_parser.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"
#include "support/parser_laws.hpp"

namespace isotrak_parser_test {

using namespace nendo;
using namespace nendo::driver::isotrak;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;
using Outcome = test::Outcome<Record>;

/// Bytes as published: groups of seven without their bits 7, which follow in a byte.
Bytes packed(const std::vector<int>& plain) {
  Bytes bytes;
  for (std::size_t begin = 0; begin < plain.size(); begin += 7) {
    int high = 0;
    for (std::size_t at = begin; at < std::min(begin + 7, plain.size()); ++at) {
      bytes.push_back(static_cast<std::byte>(plain[at] % 128));
      if (plain[at] >= 128) high += 1 << (at - begin);
    }
    bytes.push_back(static_cast<std::byte>(high));
  }
  bytes.front() |= std::byte{0x80};
  return bytes;
}

/// A record whose x is a number of steps.
Bytes record_of(int x, char station = '1', char third = '*',
                const std::array<int, 4>& wxyz = {32767, 0, 0, 0}) {
  std::vector<int> plain{'0', station, third};
  for (const int value : {x, -2, 32767, wxyz[0], wxyz[1], wxyz[2], wxyz[3]}) {
    const int word = (value + 65536) % 65536;
    plain.push_back(word % 256);
    plain.push_back(word / 256);
  }
  return packed(plain);
}

int x_of(const Record& record) {
  return static_cast<int>(std::lround(record.position_m[0] / 1.6632 * 32767));
}

using Xs = std::vector<int>;

Xs xs_of(const Outcome& outcome) {
  Xs xs;
  for (const Record& record : outcome.records)
    xs.push_back(x_of(record));
  return xs;
}

Outcome parse(std::span<const std::byte> input) {
  Outcome outcome = test::parse<Record>(Parser(), input, 20);
  CHECK(outcome.counters.record_bytes == 20 * outcome.counters.records);
  return outcome;
}

} // namespace

TEST_SUITE("isotrak_parser") {
  TEST_CASE("empty input yields no pose of an ISOTRAK") {
    CHECK(parse({}).records.empty());
  }

  TEST_CASE("a good ISOTRAK record is delivered at once, in metres, with the scalar last") {
    const Outcome outcome = parse(record_of(-32767, '2', ' ', {-3277, 22937, -16384, 16384}));
    REQUIRE(outcome.records.size() == 1);
    const Record& record = outcome.records[0];
    CHECK(record.station == 2);
    CHECK(record.error == ' ');
    CHECK(record.position_m[0] == doctest::Approx(-1.6632));
    CHECK(record.position_m[1] == doctest::Approx(-2 * 1.6632 / 32767));
    CHECK(record.position_m[2] == doctest::Approx(1.6632));
    CHECK(record.turn_xyzw[0] == doctest::Approx(0.7).epsilon(1e-4));
    CHECK(record.turn_xyzw[1] == doctest::Approx(-0.5).epsilon(1e-4));
    CHECK(record.turn_xyzw[2] == doctest::Approx(0.5).epsilon(1e-4));
    CHECK(record.turn_xyzw[3] == doctest::Approx(-0.1).epsilon(1e-3));
    CHECK(outcome.pending == 0);
  }

  TEST_CASE("an ISOTRAK's button is no error, and a letter is one") {
    for (const auto& [third, error] :
         {std::pair('*', ' '), std::pair('@', ' '), std::pair('k', 'k'), std::pair('F', 'F')}) {
      const Outcome outcome = parse(record_of(9, '1', third));
      REQUIRE(outcome.records.size() == 1);
      CHECK(outcome.records[0].error == error);
    }
  }

  TEST_CASE("each value of an ISOTRAK record is delivered") {
    for (int x = -32768; x < 32768; x += 7)
      CHECK(xs_of(parse(record_of(x))) == Xs{x});
  }

  TEST_CASE("a quaternion may be rounded or cut to the steps of an ISOTRAK's format, and is of "
            "length 1") {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int round = 0; round < 2000; ++round) {
      std::array<double, 4> wxyz{};
      double squares = 0.0;
      for (double& component : wxyz) {
        component = normal(random);
        squares += component * component;
      }
      const double length = std::sqrt(squares);
      std::array<int, 4> sent{};
      const double full = round % 2 == 0 ? 32767.0 : 32768.0; // of which sources are not sure
      for (std::size_t k = 0; k < 4; ++k) {
        const double steps = std::min(wxyz[k] / length * full, 32767.0);
        sent[k] = static_cast<int>(round % 4 < 2 ? std::round(steps) : std::trunc(steps));
      }
      const Outcome outcome = parse(record_of(9, '1', '*', sent));
      REQUIRE(outcome.records.size() == 1);
      const auto& turn = outcome.records[0].turn_xyzw;
      CHECK(std::hypot(std::hypot(turn[0], turn[1]), std::hypot(turn[2], turn[3])) ==
            doctest::Approx(1.0).epsilon(1e-12));
      for (std::size_t k = 0; k < 4; ++k)
        CHECK(std::abs(turn[k] - wxyz[(k + 1) % 4] / length) < 1e-4);
    }
  }

  TEST_CASE("two ISOTRAK records in a row are two") {
    const Outcome outcome = parse(joined({record_of(9), record_of(50, '2')}));
    CHECK(xs_of(outcome) == Xs{9, 50});
    CHECK(outcome.counters.discarded_bytes == 0);
  }

  TEST_CASE("garbage before an ISOTRAK's record is dropped and costs no record") {
    Bytes tail = record_of(3);
    tail.erase(tail.begin(), tail.begin() + 11);
    for (const Bytes& garbage :
         {tail, bytes_of("21S3F0\r\n"), bytes_of({0x80}), bytes_of({0xB0, 0xB0, '1', '*'})}) {
      const Outcome outcome = parse(joined({garbage, record_of(9), record_of(50)}));
      CHECK(xs_of(outcome) == Xs{9, 50});
      CHECK(outcome.counters.discarded_bytes == garbage.size());
      CHECK(outcome.counters.bad_records == 0);
    }
  }

  TEST_CASE("a truncated or over-long ISOTRAK record is dropped alone") {
    for (std::size_t length = 1; length < 20; ++length) {
      CAPTURE(length);
      Bytes half = record_of(9);
      half.resize(length);
      CHECK(parse(half).pending == length);
      const Outcome outcome = parse(joined({record_of(1), half, record_of(50)}));
      CHECK(xs_of(outcome) == Xs{1, 50});
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == length);
    }
    const Outcome outcome = parse(joined({record_of(1), bytes_of({1, 2, 3}), record_of(50)}));
    CHECK(xs_of(outcome) == Xs{1, 50});
    CHECK(outcome.counters.bad_records == 1);
    CHECK(outcome.counters.discarded_bytes == 3);
  }

  TEST_CASE("a wrong bit 7, begin, station or button costs one ISOTRAK record") {
    struct Flip {
      std::size_t at;
      int bits;
    };
    for (const Flip& flip :
         {Flip{0, 0x80}, Flip{0, 0x01}, Flip{1, 0x02}, Flip{1, 0x01}, Flip{1, 0x80}, Flip{2, 0x08},
          Flip{5, 0x80}, Flip{7, 0x01}, Flip{7, 0x02}, Flip{7, 0x04}, Flip{19, 0x80}}) {
      CAPTURE(flip.at);
      CAPTURE(flip.bits);
      Bytes bad = record_of(9);
      bad[flip.at] ^= static_cast<std::byte>(flip.bits);
      const Outcome outcome = parse(joined({record_of(1), bad, record_of(50)}));
      CHECK(xs_of(outcome) == Xs{1, 50});
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 20);
    }
  }

  TEST_CASE("an ISOTRAK record whose quaternion is none is dropped alone") {
    for (const std::array<int, 4>& wxyz :
         {std::array{0, 0, 0, 0}, std::array{32600, 0, 0, 0}, std::array{32767, 3000, 0, 0},
          std::array{-32768, -32768, -32768, -32768}}) {
      const Outcome outcome =
          parse(joined({record_of(1), record_of(9, '1', '*', wxyz), record_of(50)}));
      CHECK(xs_of(outcome) == Xs{1, 50});
      CHECK(outcome.counters.bad_records == 1);
    }
  }

  TEST_CASE("where an ISOTRAK's stream is cut makes no difference") {
    Bytes lost = record_of(3);
    lost.erase(lost.begin() + 12);
    const Bytes stream = joined({bytes_of({7, 0x80, 9}), record_of(1), record_of(2, '2'), lost,
                                 bytes_of({0x80, 0x80}), record_of(4), record_of(5, '3'),
                                 bytes_of("2 E*\r\n"), record_of(6), bytes_of({0xB0, '1'})});
    CHECK(test::values_however_cut<Record>(Parser(), {stream, 20}, x_of) == Xs{1, 2, 4, 6});
  }

  TEST_CASE("every byte of an ISOTRAK's stream is accounted for, however it is mutilated") {
    std::mt19937 random(5);
    std::uint64_t records = 0;
    for (int round = 0; round < 400; ++round) {
      Bytes stream;
      for (int k = 0; k < 30; ++k)
        stream = joined({stream, record_of(static_cast<int>(random() % 8192), "12"[k % 2])});
      const auto damages = random() % 10;
      test::mutilate(stream, damages, random);
      const std::uint64_t here = parse(stream).counters.records;
      CHECK(here + damages >= 30); // each costs one record at most
      records += here;
    }
    CHECK(records > 400 * 20);
  }

  TEST_CASE("after a reset the unfinished ISOTRAK record is discarded") {
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
    CHECK(parser.counters().discarded_bytes == 20 + 7);
    CHECK(parser.counters().bad_records == 0);
  }

  TEST_CASE("a file of ISOTRAK's records yields what was worked out for it by hand") {
    test::reads_as_expected<Record>(Parser(), {"isotrak_stream.bin", 20}, test::pose_line<Record>);
  }
}

} // namespace isotrak_parser_test
