#include "cyberglove/cyberglove_parser.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/parser_laws.hpp"

namespace cyberglove_parser_test {

using namespace nendo::driver::cyberglove;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;

constexpr RecordShape plain_22{22, false, false};
constexpr RecordShape full_22{22, true, true};
constexpr RecordShape plain_18{18, false, false};

/// Header, values first, first+1 ..., then `tail` and NUL: the layout as published.
Bytes record_bytes(std::size_t values, int first, std::string_view tail = "") {
  Bytes bytes{std::byte{'S'}};
  for (std::size_t k = 0; k < values; ++k)
    bytes.push_back(static_cast<std::byte>(first + static_cast<int>(k)));
  const Bytes end = bytes_of(tail);
  bytes.insert(bytes.end(), end.begin(), end.end());
  bytes.push_back(std::byte{0});
  return bytes;
}

using Outcome = nendo::test::Outcome<Record>;

Outcome parse(const RecordShape& shape, std::span<const std::byte> input) {
  return nendo::test::parse<Record>(Parser(shape), input, max_record_bytes);
}

} // namespace

TEST_SUITE("cyberglove_parser") {
  TEST_CASE("empty input yields nothing") {
    const Outcome outcome = parse(plain_22, {});
    CHECK(outcome.records.empty());
    CHECK(outcome.counters.bytes == 0);
  }

  TEST_CASE("a good record is delivered as it was sent") {
    for (const RecordShape& shape : {plain_22, plain_18}) {
      const Outcome outcome = parse(shape, record_bytes(shape.values, 100));
      REQUIRE(outcome.records.size() == 1);
      for (std::size_t k = 0; k < shape.values; ++k)
        CHECK(outcome.records[0].values[k] == 100 + k);
      CHECK(outcome.counters.discarded_bytes == 0);
      CHECK_FALSE(outcome.records[0].sampled_too_fast);
    }
  }

  TEST_CASE(
      "streamed, polled and synchronised records are known by their header, others are none") {
    Bytes record = record_bytes(22, 1);
    for (int letter = 1; letter < 256; ++letter) {
      CAPTURE(letter);
      record[0] = static_cast<std::byte>(letter);
      const bool known = letter == 'S' || letter == 'G' || letter == 'Y';
      CHECK(parse(plain_22, record).records.size() == (known ? 1 : 0));
    }
  }

  TEST_CASE("two records in a row are two, also when values look like headers") {
    const Outcome outcome =
        parse(plain_22, joined({record_bytes(22, 'S' - 3), record_bytes(22, 9)}));
    REQUIRE(outcome.records.size() == 2);
    CHECK(outcome.records[1].values[0] == 9);
  }

  TEST_CASE("garbage that ends in NUL costs no record, garbage that does not costs the next one") {
    const Outcome ended =
        parse(plain_22, joined({bytes_of(std::string("AT\r\n\0", 5)), record_bytes(22, 9)}));
    CHECK(ended.records.size() == 1);
    CHECK(ended.counters.bad_records == 1);
    CHECK(ended.counters.discarded_bytes == 5);
    const Outcome open =
        parse(plain_22, joined({bytes_of("AT\r\n"), record_bytes(22, 9), record_bytes(22, 50)}));
    REQUIRE(open.records.size() == 1);
    CHECK(open.records[0].values[0] == 50);
  }

  TEST_CASE("a truncated record is held back, and dropped when the next one follows at once") {
    Bytes half = record_bytes(22, 9);
    half.resize(10);
    CHECK(parse(plain_22, half).pending == 10);
    const Outcome outcome =
        parse(plain_22, joined({half, record_bytes(22, 9), record_bytes(22, 50)}));
    REQUIRE(outcome.records.size() == 1);
    CHECK(outcome.records[0].values[0] == 50);
    CHECK(outcome.counters.bad_records == 1);
  }

  TEST_CASE("an over-long record is dropped as one, whatever its length, and holds no memory") {
    for (const std::size_t length : {24U, 34U, 35U, 36U, 37U, 72U, 5000U}) {
      CAPTURE(length);
      Bytes overlong(length, std::byte{'S'});
      overlong.push_back(std::byte{0});
      const Outcome outcome = parse(plain_22, joined({overlong, record_bytes(22, 9)}));
      CHECK(outcome.records.size() == 1);
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == length + 1);
    }
  }

  TEST_CASE("a record with a bad terminator is dropped with the one it runs into") {
    Bytes bad = record_bytes(22, 9);
    bad.back() = std::byte{0x0D};
    const Outcome outcome =
        parse(plain_22, joined({bad, record_bytes(22, 50), record_bytes(22, 99)}));
    REQUIRE(outcome.records.size() == 1);
    CHECK(outcome.records[0].values[0] == 99);
  }

  TEST_CASE("a value of zero cannot be delivered") {
    Bytes zero = record_bytes(22, 9);
    zero[5] = std::byte{0};
    CHECK(parse(plain_22, zero).records.empty());
    CHECK_FALSE(decode_record(zero, plain_22));
  }

  TEST_CASE("the time stamp's flags say which of its bytes are zero") {
    using namespace std::string_view_literals;
    // The manual's example of the layout, with and without the flag byte's bit 7.
    for (const auto tail : {"\x8A\x02\x01\x01\x01\x87"sv, "\x0A\x02\x01\x01\x01\x87"sv}) {
      const Outcome outcome = parse(full_22, record_bytes(22, 9, tail));
      REQUIRE(outcome.records.size() == 1);
      CHECK(outcome.records[0].ticks == 0x00010002U);
    }
    CHECK(parse(full_22, record_bytes(22, 9, "\x80\x04\x03\x02\x01\x87")).records[0].ticks ==
          0x01020304U);
    CHECK(parse(full_22, record_bytes(22, 9, "\x8F\x01\x01\x01\x01\x87")).records[0].ticks == 0);
    CHECK(parse(full_22, record_bytes(22, 9, "\x8F\x01\x02\x01\x01\x87")).records.empty());
  }

  TEST_CASE("a time stamp may begin with NUL, as on gloves that never set its bit 7") {
    using namespace std::string_view_literals;
    const Bytes record = record_bytes(22, 9, "\0\x04\x03\x02\x01\x87"sv);
    const Outcome two = parse(full_22, joined({record, record}));
    REQUIRE(two.records.size() == 2);
    CHECK(two.records[1].ticks == 0x01020304U);
    CHECK(two.counters.discarded_bytes == 0);
    const auto late = parse(full_22, record_bytes(22, 9,
                                                  "\0\x04\x03\x02\x01\x87"
                                                  "es"sv));
    CHECK(late.records.size() == 1);
    // Cut off where the time stamp begins, it costs nothing but itself, whatever follows.
    for (const char* tail : {"\x80\x04\x03\x02\x01\x87", "\x80\x04\x03\x02\x01\x87"
                                                         "es"}) {
      const auto cut = parse(full_22, joined({record_bytes(22, 9), record_bytes(22, 50, tail)}));
      REQUIRE(cut.records.size() == 1);
      CHECK(cut.records[0].values[0] == 50);
      CHECK(cut.counters.bad_records == 1);
    }
    const auto twice = parse(full_22, joined({record_bytes(22, 9), Bytes{std::byte{0}}, record}));
    CHECK(twice.records.size() == 1);
    CHECK(twice.counters.bad_records == 2);
  }

  TEST_CASE("with one value, what follows a false time stamp may be a whole record") {
    const RecordShape tiny{1, true, true};
    const auto outcome =
        parse(tiny, joined({record_bytes(1, 9), Bytes{std::byte{'x'}, std::byte{0}},
                            record_bytes(1, 7, "\x80\x04\x03\x02\x01\x87")}));
    REQUIRE(outcome.records.size() == 1);
    CHECK(outcome.records[0].values[0] == 7);
    CHECK(outcome.counters.bad_records == 2);
  }

  TEST_CASE("every combination of time stamp, status and error pairs is read") {
    for (const bool stamp : {false, true}) {
      for (const bool status : {false, true}) {
        for (const std::string errors : {"", "es", "eg", "eges", "eseg"}) {
          CAPTURE(errors);
          const std::string tail =
              std::string(stamp ? "\x80\x04\x03\x02\x01" : "") + (status ? "\x83" : "") + errors;
          const auto outcome = parse({18, stamp, status}, record_bytes(18, 9, tail));
          const bool unplugged = errors.find("eg") != std::string::npos;
          CHECK(outcome.counters.unplugged == (unplugged ? 1 : 0));
          CHECK(outcome.counters.bad_records == 0);
          REQUIRE(outcome.records.size() == (unplugged ? 0 : 1));
          if (unplugged) continue;
          CHECK(outcome.records[0].ticks == (stamp ? 0x01020304U : 0U));
          CHECK(outcome.records[0].stamp == (stamp ? Stamp::continues : Stamp::none));
          CHECK(outcome.records[0].status == (status ? 0x83 : 0));
          CHECK(outcome.records[0].sampled_too_fast == (errors == "es"));
          CHECK(outcome.counters.too_fast == (errors == "es" ? 1 : 0));
        }
      }
    }
  }

  TEST_CASE("a status byte without its constant bit is damage") {
    CHECK(parse(full_22, record_bytes(22, 9, "\x8A\x02\x01\x01\x01\x07")).records.empty());
  }

  TEST_CASE("error pairs come before the NUL: too fast is a good record, unplugged is none") {
    const auto too_fast = parse(plain_22, record_bytes(22, 9, "es"));
    REQUIRE(too_fast.records.size() == 1);
    CHECK(too_fast.records[0].sampled_too_fast);
    for (const char* tail : {"eg", "eges", "eseg"}) {
      CAPTURE(tail);
      const auto outcome = parse(plain_22, record_bytes(22, 9, tail));
      CHECK(outcome.records.empty());
      CHECK(outcome.counters.unplugged == 1);
      CHECK(outcome.counters.bad_records == 0);
    }
    for (const char* tail : {"e", "ex", "eses", "egeg", "esese", "se", "xx"}) {
      CAPTURE(tail);
      CHECK(parse(plain_22, record_bytes(22, 9, tail)).records.empty());
    }
    CHECK(parse(full_22, record_bytes(22, 9,
                                      "\x8A\x02\x01\x01\x01\x87"
                                      "es"))
              .records.size() == 1);
  }

  TEST_CASE("a record of another shape is never taken for one") {
    CHECK(parse(plain_18, record_bytes(22, 9)).records.empty());
    CHECK(parse(plain_22, record_bytes(18, 9)).records.empty());
    CHECK(parse(full_22, record_bytes(22, 9)).records.empty());
  }

  TEST_CASE("where the stream is cut into chunks makes no difference") {
    const Bytes stream =
        joined({bytes_of("noise"), record_bytes(22, 1, "\x8A\x02\x01\x01\x01\x87"),
                record_bytes(22, 2, "\x81\x01\x02\x03\x04\x87"), Bytes(50, std::byte{7}),
                record_bytes(22, 3,
                             "\x81\x01\x02\x03\x04\x87"
                             "es"),
                record_bytes(22, 4, "\x81\x01\x02\x03\x04\x87")});
    const auto value_of = [](const Record& record) { return record.values[0]; };
    CHECK(nendo::test::values_however_cut<Record>(Parser(full_22), {stream, max_record_bytes},
                                                  value_of) == std::vector<int>{2, 4});
  }

  TEST_CASE("every byte is accounted for, however the stream is mutilated") {
    std::mt19937 random(5);
    for (int round = 0; round < 400; ++round) {
      Bytes stream;
      for (int k = 0; k < 30; ++k) {
        const Bytes next =
            record_bytes(22, static_cast<int>(1 + random() % 200), "\x8A\x02\x01\x01\x01\x87");
        stream.insert(stream.end(), next.begin(), next.end());
      }
      nendo::test::mutilate(stream, random() % 40, random);
      const Outcome outcome = parse(full_22, stream);
      CHECK(outcome.records.size() <= 70);
      for (const Record& record : outcome.records) {
        CHECK(std::none_of(record.values.begin(), record.values.begin() + 22,
                           [](auto v) { return v == 0; }));
      }
    }
  }

  TEST_CASE("one gap, or one run of bytes too many, puts no value into another one's place") {
    Bytes stream;
    for (int k = 0; k < 6; ++k) {
      Bytes next = record_bytes(22, 0,
                                k % 2 == 0 ? "\x81\x01\x02\x03\x04\x87"
                                           : "\x82\x05\x01\x03\x04\x87"
                                             "es");
      for (std::size_t value = 0; value < 22; ++value) // a value shows its sensor
        next[1 + value] = static_cast<std::byte>(10 * (value + 1) + static_cast<std::size_t>(k));
      stream.insert(stream.end(), next.begin(), next.end());
    }
    const auto check_places = [](std::span<const std::byte> input, std::size_t least) {
      const Outcome outcome = parse(full_22, input);
      CHECK(outcome.records.size() >= least);
      for (const Record& record : outcome.records) {
        for (std::size_t value = 0; value < 22; ++value)
          CHECK(record.values[value] / 10 == value + 1);
      }
    };
    for (std::size_t at = 0; at < stream.size(); ++at) {
      for (std::size_t length = 1; length <= 70 && at + length <= stream.size(); ++length) {
        Bytes gap = stream;
        const auto from = gap.begin() + static_cast<std::ptrdiff_t>(at);
        gap.erase(from, from + static_cast<std::ptrdiff_t>(length));
        check_places(gap, length < 30 ? 4 : 2);
      }
      for (std::size_t length = 1; length <= 8; ++length) {
        Bytes run = stream;
        run.insert(run.begin() + static_cast<std::ptrdiff_t>(at), length, std::byte{'S'});
        check_places(run, 5);
      }
    }
  }

  TEST_CASE("what a judge refuses is bad and implausible, and its bytes are discarded") {
    Parser parser(plain_22);
    std::vector<int> delivered;
    const auto judge = [](Record& record) {
      return record.values[0] == 50 ? Verdict{false, 0} : Verdict{true, 3};
    };
    const auto sink = [&](const Record& record) { delivered.push_back(record.values[0]); };
    parser.push(joined({record_bytes(22, 9), record_bytes(22, 50), record_bytes(22, 60)}), judge,
                sink);
    CHECK(delivered == std::vector<int>{9, 60});
    const auto& counters = parser.counters();
    CHECK(counters.records == 2);
    CHECK(counters.implausible == 1);
    CHECK(counters.bad_records == 1);
    CHECK(counters.missed == 6);
    CHECK(counters.record_bytes == 48);
    CHECK(counters.discarded_bytes == 24);
  }

  TEST_CASE("after a reset the unfinished record is discarded and the new shape holds") {
    Parser parser(plain_22);
    int records = 0;
    const auto count = [&](const Record&) { ++records; };
    Bytes half = record_bytes(22, 9);
    half.resize(10);
    parser.push(half, count);
    parser.reset(plain_18);
    parser.count_discarded(7);
    parser.push(record_bytes(18, 9), count);
    CHECK(records == 1);
    CHECK(parser.counters().discarded_bytes == 17);
    CHECK(parser.counters().bytes == 17 + 20);
  }
}

} // namespace cyberglove_parser_test
