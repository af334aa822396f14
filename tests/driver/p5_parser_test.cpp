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
  std::string buttons;
  if (report.button_a) buttons += 'A';
  if (report.button_b) buttons += 'B';
  if (report.button_c) buttons += 'C';
  text << " buttons " << (buttons.empty() ? "-" : buttons);
  for (std::size_t k = 0; k < report.light_count; ++k) {
    const SeenLight& light = report.lights[k];
    text << " light " << unsigned{light.number} << ' ' << light.v2 << ' ' << light.v1 << ' '
         << light.h;
  }
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

  TEST_CASE("each button has its bit, and the fourth bit is nobody's") {
    for (unsigned buttons = 0; buttons < 16; ++buttons) {
      Bytes bytes = empty_report();
      bytes[5] = static_cast<std::byte>(buttons << 4U | 8U);
      const auto report = decode_report(bytes);
      REQUIRE(report);
      CHECK(report->button_a == ((buttons & 1U) != 0));
      CHECK(report->button_b == ((buttons & 2U) != 0));
      CHECK(report->button_c == ((buttons & 4U) != 0));
      CHECK(report->light_count == 0);
    }
  }

  TEST_CASE("a light's three tangents are ten bits each, signed, wherever the light stands") {
    for (std::size_t place = 0; place < 4; ++place) {
      for (const int value : {0, 1, -1, 511, -512, 300, -300}) {
        CAPTURE(place);
        CAPTURE(value);
        Bytes bytes = empty_report();
        const auto put = [&bytes](std::size_t at, unsigned bits, std::size_t count) {
          for (std::size_t k = 0; k < count; ++k) {
            const auto mask = static_cast<std::byte>(0x80U >> (at + k) % 8);
            const bool one = (bits >> (count - 1 - k) & 1U) != 0;
            std::byte& byte = bytes[(at + k) / 8];
            byte = one ? byte | mask : byte & ~mask;
          }
        };
        put(44 + 4 * place, 5, 4);
        put(60 + 30 * place, static_cast<unsigned>(value) & 0x3FFU, 10);
        put(60 + 30 * place + 10, 0x3FF, 10);
        put(60 + 30 * place + 20, 2, 10);
        const auto report = decode_report(bytes);
        REQUIRE(report);
        REQUIRE(report->light_count == 1);
        CHECK(report->lights[0] == SeenLight{5, static_cast<std::int16_t>(value), -1, 2});
      }
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
        for (const SeenLight& light : decoded->lights) {
          CHECK(light.number < 8);
          CHECK(light.h >= -512);
          CHECK(light.h <= 511);
        }
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
