#include <nendo/base/byte_writer.hpp>

#include <cmath>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include <nendo/base/byte_reader.hpp>

namespace byte_writer_test {

using nendo::ByteReader;
using nendo::ByteWriter;

TEST_SUITE("byte_writer") {
  TEST_CASE("numbers are least significant byte first") {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    writer.u8(0x01);
    writer.u16_le(0x0302);
    writer.u32_le(0x07060504);
    writer.u64_le(0x0F0E0D0C0B0A0908);
    writer.i64_le(-2);
    writer.f64_le(1.0); // sign 0, exponent 1023, no fraction
    writer.text("ab");
    std::vector<std::byte> expected;
    for (unsigned byte = 1; byte <= 15; ++byte)
      expected.push_back(static_cast<std::byte>(byte));
    for (const int byte : {0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0,    0,
                           0,    0,    0,    0,    0xF0, 0x3F, 2,    0,    0x61, 0x62})
      expected.push_back(static_cast<std::byte>(byte));
    CHECK(bytes == expected);
  }

  TEST_CASE("big-endian numbers are most significant byte first") {
    std::vector<std::byte> bytes;
    ByteWriter(bytes).u32_be(0x01020384);
    CHECK(bytes == std::vector{std::byte{0x01}, std::byte{0x02}, std::byte{0x03}, std::byte{0x84}});
  }

  TEST_CASE("a reader reads back what was written, to the bit") {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    writer.u64_le(UINT64_MAX - 5);
    writer.i64_le(std::numeric_limits<std::int64_t>::min());
    writer.f64_le(-0.0);
    writer.f64_le(0.1);
    writer.f64_le(std::numeric_limits<double>::infinity());
    writer.text("");
    writer.text(std::string(70000, 'x')); // longer than its length can be
    ByteReader reader(bytes);
    CHECK(reader.u64_le() == UINT64_MAX - 5);
    CHECK(reader.i64_le() == std::numeric_limits<std::int64_t>::min());
    CHECK(std::signbit(reader.f64_le()));
    CHECK(reader.f64_le() == 0.1);
    CHECK(reader.f64_le() == std::numeric_limits<double>::infinity());
    CHECK(reader.text().empty());
    CHECK(reader.text() == std::string(65535, 'x'));
    CHECK(reader.remaining() == 0);
    CHECK_FALSE(reader.overrun());
    CHECK(reader.text().empty());
    CHECK(reader.overrun());
  }
}

} // namespace byte_writer_test
