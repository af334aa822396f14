#include "fivedt/fivedt_parser.hpp"

#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"
#include "support/parser_laws.hpp"

namespace fivedt_parser_test {

using namespace nendo;
using namespace nendo::driver::fivedt;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;

/// Fingers first, first+1 ..., pitch and roll; the layout as published.
Bytes sample_bytes_of(int first, int pitch = 90, int roll = 91) {
  const Bytes data = bytes_of({first, first + 1, first + 2, first + 3, first + 4, pitch, roll});
  Bytes bytes = bytes_of({0x80});
  std::byte sum{0};
  for (const std::byte byte : data) {
    bytes.push_back(byte);
    sum ^= byte;
  }
  bytes.push_back(sum);
  return bytes;
}

using Firsts = std::vector<int>;
using Outcome = test::Outcome<Record>;

Outcome parse(std::span<const std::byte> input) {
  Outcome outcome = test::parse<Record>(Parser(), input, 9);
  CHECK(outcome.counters.record_bytes == 9 * outcome.counters.records);
  return outcome;
}

} // namespace

TEST_SUITE("fivedt_parser") {
  TEST_CASE("empty input yields no sample") {
    CHECK(parse({}).firsts().empty());
  }

  TEST_CASE("a good sample is delivered as it was sent") {
    Parser parser;
    int samples = 0;
    // 10 ^ 20 ^ 30 = 0 and 40 ^ 50 = 26; pitch and roll cancel each other out.
    parser.push(bytes_of({0x80, 10, 20, 30, 40, 50, 77, 77, 26}), [&](const Record& record) {
      ++samples;
      CHECK(record.flexion == std::array<std::uint8_t, 5>{10, 20, 30, 40, 50});
    });
    CHECK(samples == 1);
    CHECK(parser.pending() == 0);
  }

  TEST_CASE("two samples in a row are two") {
    CHECK(parse(joined({sample_bytes_of(9), sample_bytes_of(50)})).firsts() == Firsts{9, 50});
  }

  TEST_CASE("values may look like headers") {
    const Outcome outcome =
        parse(joined({sample_bytes_of(0x80, 0x80, 0x80), sample_bytes_of(0x7E),
                      bytes_of({0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80}),
                      sample_bytes_of(0x80, 0x80, 0x80)}));
    CHECK(outcome.firsts() == Firsts{0x80, 0x7E, 0x80, 0x80});
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("garbage before a sample is dropped and costs no sample, even with headers in it") {
    for (const Bytes& garbage :
         {bytes_of({1, 2, 3}), bytes_of({0x80}), bytes_of({0x80, 0x80, 0x80}),
          bytes_of({0x55, 0x80, 1, 2, 3, 4, 5})}) {
      const Outcome outcome = parse(joined({garbage, sample_bytes_of(9), sample_bytes_of(50)}));
      CHECK(outcome.firsts() == Firsts{9, 50});
      CHECK(outcome.counters.discarded_bytes == garbage.size());
      CHECK(outcome.counters.bad_records == 0); // no mark shows where a sample should have begun
    }
  }

  TEST_CASE("a truncated sample is held back, and dropped when the next one follows at once") {
    Bytes half = sample_bytes_of(9);
    half.resize(5);
    CHECK(parse(half).pending == 5);
    const Outcome outcome =
        parse(joined({sample_bytes_of(1), half, sample_bytes_of(9), sample_bytes_of(50)}));
    CHECK(outcome.firsts() == Firsts{1, 9, 50});
    CHECK(outcome.counters.bad_records == 1);
    CHECK(outcome.counters.discarded_bytes == 5);
  }

  TEST_CASE("an over-long sample is good, and what is too much of it is dropped") {
    const Bytes more = bytes_of({1, 2, 3, 4, 5});
    const Outcome outcome = parse(joined({sample_bytes_of(9), more, sample_bytes_of(50)}));
    CHECK(outcome.firsts() == Firsts{9, 50});
    CHECK(outcome.counters.discarded_bytes == more.size());
    CHECK(outcome.counters.bad_records == 1);
  }

  TEST_CASE("a sample with a bad checksum or header is dropped alone and counted once") {
    for (const std::size_t damaged : {std::size_t{0}, std::size_t{3}, std::size_t{8}}) {
      Bytes bad = sample_bytes_of(9);
      bad[damaged] ^= std::byte{0x01};
      const Outcome outcome =
          parse(joined({sample_bytes_of(1), bad, sample_bytes_of(50), sample_bytes_of(60)}));
      CHECK(outcome.firsts() == Firsts{1, 50, 60});
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 9);
    }
  }

  TEST_CASE("one byte more before or after each sample is no fault") {
    for (const int extra : {0x55, 0x01, 0x40, 0x00, 0x80}) {
      CAPTURE(extra);
      const Bytes byte = bytes_of({extra});
      const Outcome outcome = parse(joined(
          {byte, sample_bytes_of(9), byte, sample_bytes_of(50), byte, sample_bytes_of(70), byte}));
      CHECK(outcome.firsts() == Firsts{9, 50, 70});
      CHECK(outcome.counters.bad_records == 0);
    }
  }

  TEST_CASE("where a 5DT stream is cut makes no difference") {
    Bytes bad = sample_bytes_of(3);
    bad[4] = std::byte{0x80};
    const Bytes stream =
        joined({bytes_of({0x55, 7, 0x80}), sample_bytes_of(1), sample_bytes_of(2), bad,
                bytes_of({0x80, 0x80}), sample_bytes_of(4), bytes_of({0x55}), sample_bytes_of(5)});
    const auto value_of = [](const Record& record) { return record.flexion[0]; };
    CHECK(test::values_however_cut<Record>(Parser(), {stream, 9}, value_of) == Firsts{1, 2, 4, 5});
  }

  TEST_CASE("every byte of a 5DT stream is accounted for, however it is mutilated") {
    std::mt19937 random(5);
    std::uint64_t samples = 0;
    for (int round = 0; round < 400; ++round) {
      Bytes stream;
      for (int k = 0; k < 30; ++k) {
        const Bytes next = sample_bytes_of(static_cast<int>(random() % 250));
        stream.insert(stream.end(), next.begin(), next.end());
      }
      test::mutilate(stream, random() % 20, random);
      samples += parse(stream).counters.records;
    }
    CHECK(samples > 400 * 15); // the damage is local
  }

  TEST_CASE("after a reset the unfinished sample is discarded") {
    Parser parser;
    int samples = 0;
    const auto count = [&](const Record&) { ++samples; };
    Bytes half = sample_bytes_of(9);
    half.resize(5);
    parser.push(half, count);
    parser.reset();
    parser.count_discarded(7);
    parser.push(sample_bytes_of(50), count);
    CHECK(samples == 1);
    CHECK(parser.counters().discarded_bytes == 5 + 7);
    CHECK(parser.counters().bytes == 5 + 7 + 9);
    CHECK(parser.counters().bad_records == 0);
  }

  TEST_CASE("a file of samples yields what was worked out for it by hand") {
    for (const char* name : {"fivedt_wired.bin", "fivedt_wireless.bin"}) {
      test::reads_as_expected<Record>(Parser(), {name, 9}, [](const Record& record) {
        std::string line;
        for (std::size_t k = 0; k < fingers; ++k)
          line += (k == 0 ? "" : " ") + std::to_string(record.flexion[k]);
        return line;
      });
    }
  }
}

TEST_SUITE("fivedt_information") {
  namespace {
  // Version 1.4, a left hand, pitch and roll, and a name.
  Bytes answer(std::string_view name = "Glove") {
    Bytes bytes(32);
    const Bytes head = bytes_of({'B', 'R', 1, 4, 0xFE, 0x10});
    std::copy(head.begin(), head.end(), bytes.begin());
    for (std::size_t k = 0; k < name.size(); ++k)
      bytes[16 + k] = static_cast<std::byte>(name[k]);
    return bytes;
  }
  std::span<const std::byte, 32> fixed(const Bytes& bytes) {
    return std::span(bytes).first<32>();
  }
  } // namespace

  TEST_CASE("the answer says version, hand, abilities and name") {
    const auto left = decode_information(fixed(answer()));
    REQUIRE(left);
    CHECK(left->side == Side::left);
    CHECK(left->version_major == 1);
    CHECK(left->version_minor == 4);
    CHECK(left->tilt_sensor);
    CHECK(left->name == "Glove");
    Bytes right = answer();
    right[4] = std::byte{1};
    right[5] = std::byte{0xEF};
    CHECK(decode_information(fixed(right))->side == Side::right);
    CHECK_FALSE(decode_information(fixed(right))->tilt_sensor);
    right[1] = std::byte{'X'};
    CHECK_FALSE(decode_information(fixed(right)));
  }

  TEST_CASE("a name is one printable line, whatever bytes it is made of") {
    CHECK(decode_information(fixed(answer("  a\x1B[2J\nb\x80  ")))->name == "a[2Jb");
    CHECK(decode_information(fixed(answer("0123456789ABCDEF")))->name == "0123456789ABCDEF");
    CHECK(decode_information(fixed(answer("   ")))->name.empty());
    CHECK(decode_information(fixed(answer("")))->name.empty());
  }

  TEST_CASE("the answer is found behind other bytes, wherever it is cut") {
    const Bytes stream =
        joined({bytes_of({0x55, 0x80, 'B', 'B', 'X', 'R', 'B'}), answer(), bytes_of({0x55, 'B'})});
    for (std::size_t first = 0; first <= stream.size(); ++first) {
      InformationFinder finder;
      const bool early = finder.push(std::span(stream).first(first));
      CHECK(early == (first >= 7 + 32));
      CHECK(finder.push(std::span(stream).subspan(first)));
      CHECK(decode_information(finder.answer())->name == "Glove");
    }
  }
}

} // namespace fivedt_parser_test
