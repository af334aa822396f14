#include "p5/p5_parser.hpp"

#include <random>
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include "support/captures.hpp"

namespace p5_parser_test {

using namespace nendo::driver::p5;

namespace {

using Bytes = nendo::test::StreamBytes;

/// A whole report with nothing in it: straight fingers, no button, no light.
Bytes empty_report() {
  Bytes bytes(24, std::byte{0});
  bytes[0] = std::byte{1};
  bytes[5] = std::byte{0x08}; // buttons 0, first light's number 8
  bytes[6] = std::byte{0x88};
  bytes[7] = std::byte{0x80};
  return bytes;
}

std::string text_of(const Report& report) {
  std::ostringstream text;
  text << "bends";
  for (const unsigned bend : report.bends)
    text << ' ' << bend;
  text << " button " << (report.button_a ? "A" : "-");
  return text.str();
}

} // namespace

TEST_SUITE("p5_parser") {
  TEST_CASE("P5 reports that were put together by hand read as their author meant them") {
    nendo::test::reports_read_as_meant("p5_reports.txt", 8, [](const Bytes& bytes) {
      const auto report = decode_report(bytes);
      return report ? text_of(*report) : "none";
    });
  }

  TEST_CASE("each of the 30 bits of bend belongs to one finger, the most significant first") {
    for (std::size_t bit = 0; bit < 30; ++bit) {
      CAPTURE(bit);
      Bytes bytes = empty_report();
      bytes[1 + bit / 8] |= static_cast<std::byte>(0x80U >> bit % 8);
      const auto report = decode_report(bytes);
      REQUIRE(report);
      for (std::size_t finger = 0; finger < 5; ++finger)
        CHECK(report->bends[finger] == (finger == bit / 6 ? 32U >> bit % 6 : 0U));
    }
  }

  TEST_CASE("button A has its bit, and the others are ignored") {
    for (unsigned buttons = 0; buttons < 16; ++buttons) {
      Bytes bytes = empty_report();
      bytes[5] = static_cast<std::byte>(buttons << 4U | 8U);
      const auto report = decode_report(bytes);
      REQUIRE(report);
      CHECK(report->button_a == ((buttons & 1U) != 0));
    }
  }

  TEST_CASE("a short, over-long or foreign report is none") {
    for (std::size_t length = 0; length <= 100; ++length) {
      Bytes bytes = empty_report();
      bytes.resize(length);
      CHECK(decode_report(bytes).has_value() == (length == 24));
    }
    for (unsigned number = 0; number < 256; ++number) {
      Bytes bytes = empty_report();
      bytes[0] = static_cast<std::byte>(number);
      CHECK(decode_report(bytes).has_value() == (number == 1));
    }
  }

  TEST_CASE("every byte is accounted for, and nothing leaves its range, whatever comes") {
    std::mt19937 random(11);
    Parser parser;
    std::uint64_t records = 0;
    std::uint64_t bytes = 0;
    for (int round = 0; round < 5000; ++round) {
      Bytes report(random() % 3 == 0 ? random() % 64 : 24);
      for (std::byte& byte : report)
        byte = static_cast<std::byte>(random());
      if (!report.empty() && random() % 2 == 0) report[0] = std::byte{1};
      bytes += report.size();
      if (const auto decoded = parser.push(report)) {
        ++records;
        for (const unsigned bend : decoded->bends)
          CHECK(bend <= 63);
      }
      const auto& counters = parser.counters();
      REQUIRE(counters.bytes == bytes);
      REQUIRE(counters.bytes == counters.record_bytes + counters.discarded_bytes);
      REQUIRE(counters.records == records);
      REQUIRE(counters.record_bytes == 24 * records);
      REQUIRE(counters.records + counters.bad_records == static_cast<std::uint64_t>(round) + 1);
    }
    CHECK(records > 1000);
    parser.count_discarded(7);
    CHECK(parser.counters().bytes == bytes + 7);
  }
}

} // namespace p5_parser_test
