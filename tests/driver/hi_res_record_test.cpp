#include "cyberglove/cyberglove_parser.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/parser_laws.hpp"

namespace hi_res_record_test {

using namespace nendo::driver::cyberglove;
using namespace std::chrono_literals;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;

constexpr RecordShape shape{22, false, false, RecordForm::hi_res};

/// Time, 22 values first, first + step ..., CR LF NUL: the layout as published.
Bytes hi_res(std::string_view time, unsigned first, unsigned step = 100) {
  Bytes bytes = bytes_of(time);
  for (unsigned k = 0; k < 22; ++k) {
    const unsigned value = first + k * step;
    bytes.push_back(static_cast<std::byte>(value >> 8U));
    bytes.push_back(static_cast<std::byte>(value & 0xFFU));
  }
  for (const char c : {'\r', '\n', '\0'})
    bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}

const Bytes one = hi_res("10:20:30:15:2S", 1); ///< its values hold NULs
const Bytes two = hi_res("10:20:30:16:0S", 0x0D0A, 0);

using Outcome = nendo::test::Outcome<Record>;

Outcome parse(std::span<const std::byte> input) {
  Outcome outcome = nendo::test::parse<Record>(Parser(shape), input, 61);
  CHECK(outcome.counters.record_bytes == 61 * outcome.records.size());
  return outcome;
}

/// `time` in front of good values; nothing if it is refused.
std::vector<Record> with_time(std::string_view time) {
  return parse(hi_res(time, 1)).records;
}

} // namespace

TEST_SUITE("hi_res_record") {
  TEST_CASE("empty input yields nothing") {
    CHECK(parse({}).records.empty());
  }

  TEST_CASE("a good record is delivered as it was sent, high bytes first") {
    CHECK(one.size() == 61);
    CHECK(shape.bytes() == 61);
    const Outcome outcome = parse(one);
    REQUIRE(outcome.records.size() == 1);
    for (std::size_t k = 0; k < 22; ++k)
      CHECK(outcome.records[0].values[k] == 1 + 100 * k);
    CHECK(outcome.records[0].second == 10U * 3600 + 20 * 60 + 30);
    CHECK(outcome.records[0].frame == 15);
    CHECK(outcome.records[0].sub_frame == 2);
    CHECK(outcome.records[0].stamp == Stamp::none);
    CHECK(outcome.counters.discarded_bytes == 0);
  }

  TEST_CASE("two records in a row are two, also when their values look like tails") {
    const Outcome outcome = parse(joined({two, one, two}));
    CHECK(outcome.records.size() == 3);
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("bytes before a record cost nothing, echoes and half a time included") {
    for (const std::string_view garbage :
         {std::string_view("e1S"), std::string_view("1E4010111\0001S\0", 13),
          std::string_view("10:20"), std::string_view("1"), std::string_view("\0\0\0", 3),
          std::string_view("10:20:30:15:2")}) {
      const Outcome outcome = parse(joined({bytes_of(garbage), one, two}));
      CHECK(outcome.records.size() == 2);
      CHECK(outcome.counters.discarded_bytes == garbage.size());
      CHECK(outcome.counters.bad_records == 0);
    }
  }

  TEST_CASE("a truncated record costs only itself, wherever it is cut") {
    for (std::size_t length = 1; length < one.size(); ++length) {
      CAPTURE(length);
      const Bytes half(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(length));
      CHECK(parse(half).pending == length);
      const Outcome outcome = parse(joined({half, two, one}));
      CHECK(outcome.records.size() == 2);
      CHECK(outcome.counters.bad_records == (length >= 14 ? 1 : 0));
    }
  }

  TEST_CASE("an over-long record is dropped as one, and the next one is read") {
    for (const std::size_t excess : {1U, 2U, 60U, 1000U}) {
      Bytes overlong = one;
      overlong.insert(overlong.end() - 3, excess, std::byte{7});
      const Outcome outcome = parse(joined({overlong, two}));
      CHECK(outcome.records.size() == 1);
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 61 + excess);
    }
  }

  TEST_CASE("a damaged byte of time or tail makes one bad record and costs no other") {
    for (std::size_t at = 0; at < 61; ++at) {
      if (at >= 14 && at < 58) continue; // values
      CAPTURE(at);
      Bytes damaged = one;
      damaged[at] ^= std::byte{0x40};
      const Outcome outcome = parse(joined({damaged, two}));
      CHECK(outcome.records.size() == 1);
      CHECK(outcome.counters.bad_records == 1);
    }
  }

  TEST_CASE("a sensor that sends 0 has failed: it counts as 1, and the others are read") {
    Bytes none = one;
    none[14] = none[15] = std::byte{0};
    none[56] = none[57] = std::byte{0};
    const Outcome outcome = parse(none);
    REQUIRE(outcome.records.size() == 1);
    CHECK(outcome.records[0].values[0] == 1);
    CHECK(outcome.records[0].values[1] == 101);
    CHECK(outcome.records[0].values[21] == 1);
    CHECK(outcome.records[0].clamped == 2);
    CHECK(outcome.counters.clamped == 2);
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("a record in which all sensors have failed is that of no glove") {
    const Outcome outcome = parse(joined({one, hi_res("10:20:30:15:2S", 0, 0), two}));
    CHECK(outcome.records.size() == 2);
    CHECK(outcome.counters.unplugged == 1);
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("values of more than 12 bits cannot be delivered") {
    Bytes large = one;
    large[20] = std::byte{0x10};
    CHECK(parse(joined({large, two})).records.size() == 1);
    const Bytes most = hi_res("00:00:00:00:0S", 4095, 0);
    REQUIRE(parse(most).records.size() == 1);
    CHECK(decode_record(most, shape)->values[21] == 4095);
    CHECK_FALSE(decode_record(std::span(most).first(60), shape));
  }

  TEST_CASE("the time of day is read to the sub-frame") {
    struct Row {
      const char* time;
      std::uint32_t second;
      int frame, sub_frame;
    };
    for (const Row& row :
         {Row{"00:00:00:00:0S", 0, 0, 0}, Row{"10:20:30:15:0S", 37'230, 15, 0},
          Row{"23:59:59:30:0S", 86'399, 30, 0}, Row{"10:20:30:01:9S", 37'230, 1, 9},
          Row{"10:20:31:01:3S", 37'231, 1, 3}}) {
      CAPTURE(row.time);
      const Record record = with_time(row.time).at(0);
      CHECK(record.second == row.second);
      CHECK(record.frame == row.frame);
      CHECK(record.sub_frame == row.sub_frame);
    }
    for (const char* impossible : {"24:00:00:00:0S", "00:60:00:00:0S", "00:00:60:00:0S",
                                   "00:00:00:31:0S", "0a:00:00:00:0S", "00:00:00:00:aS"}) {
      CAPTURE(impossible);
      CHECK(with_time(impossible).empty());
    }
  }

  TEST_CASE("where the stream is cut into chunks makes no difference") {
    const Bytes stream = joined(
        {bytes_of("e1S"), one, bytes_of("10:20:30:15:2Sx"), two, Bytes(70, std::byte{0}), one});
    const auto value_of = [](const Record& record) { return record.values[0]; };
    CHECK(nendo::test::values_however_cut<Record>(Parser(shape), {stream, 61}, value_of) ==
          std::vector<int>{1, 0x0D0A, 1});
  }

  TEST_CASE("every byte is accounted for, and untouched records are delivered, under mutation") {
    std::mt19937 random(11);
    for (int round = 0; round < 300; ++round) {
      Bytes stream;
      std::size_t untouched = 0;
      for (int k = 0; k < 20; ++k) {
        Bytes next = k % 2 == 0 ? one : two;
        const auto at = next.begin() + static_cast<std::ptrdiff_t>(random() % next.size());
        switch (random() % 6) {
        case 0:
          *at ^= static_cast<std::byte>(1 + random() % 255);
          break;
        case 1:
          next.erase(at);
          break;
        case 2:
          next.insert(at, static_cast<std::byte>(random()));
          break;
        default:
          ++untouched;
        }
        stream.insert(stream.end(), next.begin(), next.end());
      }
      const Outcome outcome = parse(stream);
      CHECK(outcome.records.size() >= untouched);
      CHECK(outcome.counters.bad_records + outcome.records.size() <= 20);
      for (const Record& record : outcome.records) {
        CHECK(std::all_of(record.values.begin(), record.values.begin() + 22,
                          [](auto value) { return value >= 1 && value <= 4095; }));
      }
    }
  }

  TEST_CASE("after a reset to the plain form the unfinished record is discarded") {
    Parser parser(shape);
    int records = 0;
    const auto count = [&](const Record&) { ++records; };
    parser.push(std::span(one).first(40), count);
    parser.reset({1, false, false});
    CHECK(parser.pending() == 0);
    parser.push(bytes_of(std::string_view("S\x07\0", 3)), count);
    CHECK(records == 1);
    CHECK(parser.counters().discarded_bytes == 40);
  }
}

} // namespace hi_res_record_test
