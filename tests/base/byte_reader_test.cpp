#include <nendo/base/byte_reader.hpp>

#include <array>
#include <initializer_list>
#include <vector>

#include <doctest/doctest.h>

namespace byte_reader_test {

using nendo::ByteReader;

namespace {
constexpr std::array<std::byte, 6> bytes{std::byte{0x01}, std::byte{0x02}, std::byte{0x03},
                                         std::byte{0x04}, std::byte{0x85}, std::byte{0xF6}};
} // namespace

TEST_SUITE("byte_reader") {
  TEST_CASE("multi-byte numbers are read least significant byte first") {
    ByteReader reader(bytes);
    CHECK(reader.u16_le() == 0x0201);
    CHECK(reader.u32_le() == 0xF6850403U);
    CHECK(reader.remaining() == 0);
    CHECK_FALSE(reader.overrun());
    CHECK(ByteReader(bytes).u24_le() == 0x030201U);
  }

  TEST_CASE("big-endian numbers are read most significant byte first") {
    CHECK(ByteReader(bytes).u32_be() == 0x01020304U);
    ByteReader reader(bytes);
    CHECK(reader.u64_be() == 0x0102030485F60000U);
    CHECK(reader.overrun());
    const auto bytes_of = [](std::initializer_list<int> values) {
      std::vector<std::byte> made;
      for (const int value : values)
        made.push_back(static_cast<std::byte>(value));
      return made;
    };
    const auto minus_two = bytes_of({0xFF, 0xFF, 0xFF, 0xFE});
    CHECK(ByteReader(minus_two).i32_be() == -2);
    const auto one = bytes_of({0x3F, 0xF0, 0, 0, 0, 0, 0, 0}); // exponent 1023, no fraction
    CHECK(ByteReader(one).f64_be() == 1.0);
  }

  TEST_CASE("reading past the end gives zeros and is remembered") {
    ByteReader reader{std::span(bytes).first(3)};
    CHECK(reader.u32_le() == 0x030201U);
    CHECK(reader.overrun());
    CHECK(reader.u8() == 0);
    CHECK(reader.take(1).empty());
    CHECK(reader.overrun());
  }

  TEST_CASE("take hands out exactly what is asked for") {
    ByteReader reader(bytes);
    CHECK(reader.take(4).size() == 4);
    CHECK(reader.u8() == 0x85);
    CHECK_FALSE(reader.overrun());
    CHECK(reader.take(2).size() == 1);
    CHECK(reader.overrun());
  }
}

} // namespace byte_reader_test
