#include "fivedt_usb/fivedt_usb_parser.hpp"

#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"

namespace fivedt_usb_parser_test {

using namespace nendo;
using namespace nendo::driver::fivedt_usb;

using Bytes = nendo::test::StreamBytes;

TEST_SUITE("fivedt_usb_parser") {
  TEST_CASE("5DT Ultra reports that were put together by hand read as their author meant them") {
    test::reports_read_as_meant("fivedt_usb_reports.txt", 4, [](const Bytes& bytes) {
      const auto report = decode_report(bytes);
      if (!report) return std::string("none");
      std::string text;
      for (const unsigned value : report->values)
        text += (text.empty() ? "" : " ") + std::to_string(value);
      return text;
    });
  }

  TEST_CASE("a value is two bytes, high byte first, and stays within 0 and 4095") {
    for (int value = -32768; value <= 32767; value += 7) {
      Bytes bytes(64, std::byte{0});
      for (std::size_t k = 0; k < 32; k += 2) {
        bytes[k] = static_cast<std::byte>(value >> 8);
        bytes[k + 1] = static_cast<std::byte>(value & 0xFF);
      }
      const auto report = decode_report(bytes);
      REQUIRE(report);
      const int expected = value < 0 ? 0 : value > 4095 ? 4095 : value;
      for (const int read : report->values)
        REQUIRE(read == expected);
      for (const bool clamped : report->clamped)
        REQUIRE(clamped == (value != expected));
    }
  }

  TEST_CASE("a report of any other length is none, and every byte is accounted for") {
    Parser parser;
    std::uint64_t bytes = 0;
    for (std::size_t length = 0; length <= 200; ++length) {
      bytes += length;
      CHECK(parser.push(Bytes(length, std::byte{1})).has_value() == (length == 64));
      const auto& counters = parser.counters();
      REQUIRE(counters.bytes == bytes);
      REQUIRE(counters.bytes == counters.record_bytes + counters.discarded_bytes);
    }
    CHECK(parser.counters().record_bytes == 64);
    CHECK(parser.counters().bad_records == 200);
  }

  TEST_CASE("the product number has hand, link and sensors, and other devices are refused") {
    struct Known {
      std::uint16_t product;
      Model model;
    };
    // As the driver that ran on these gloves lists them.
    const std::vector<Known> list{
        {0x0000, {Side::right, Link::cable, false}},
        {0x0001, {Side::left, Link::cable, false}},
        {0x0002, {Side::right, Link::wireless_a, false}},
        {0x0003, {Side::left, Link::wireless_a, false}},
        {0x0006, {Side::right, Link::wireless_b, false}},
        {0x0007, {Side::left, Link::wireless_b, false}},
        {0x0010, {Side::right, Link::cable, true}},
        {0x0011, {Side::left, Link::cable, true}},
        {0x0012, {Side::right, Link::wireless_a, true}},
        {0x0013, {Side::left, Link::wireless_a, true}},
        {0x0016, {Side::right, Link::wireless_b, true}},
        {0x0017, {Side::left, Link::wireless_b, true}},
    };
    for (const Known& known : list) {
      CAPTURE(known.product);
      CHECK(model_of(known.product) == known.model);
    }
    unsigned found = 0;
    for (unsigned product = 0; product <= 0xFFFF; ++product)
      found += model_of(static_cast<std::uint16_t>(product)) ? 1U : 0U;
    CHECK(found == list.size());
  }
}

} // namespace fivedt_usb_parser_test
