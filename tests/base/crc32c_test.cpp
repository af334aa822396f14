#include <nendo/base/crc32c.hpp>

#include <algorithm>
#include <numeric>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

namespace crc32c_test {

using nendo::crc32c;

namespace {

std::uint32_t sum_of(std::string_view text) {
  return crc32c(std::as_bytes(std::span(text)));
}

std::uint32_t sum_of(const std::vector<std::uint8_t>& bytes) {
  return crc32c(std::as_bytes(std::span(bytes)));
}

} // namespace

TEST_SUITE("crc32c") {
  TEST_CASE("the examples of RFC 3720, appendix B.4, and the usual check value") {
    std::vector<std::uint8_t> counting(32);
    std::iota(counting.begin(), counting.end(), std::uint8_t{0});
    CHECK(sum_of(std::vector<std::uint8_t>(32, 0x00)) == 0x8A9136AA);
    CHECK(sum_of(std::vector<std::uint8_t>(32, 0xFF)) == 0x62A8AB43);
    CHECK(sum_of(counting) == 0x46DD794E);
    std::reverse(counting.begin(), counting.end());
    CHECK(sum_of(counting) == 0x113FDB5C);
    CHECK(sum_of("123456789") == 0xE3069283);
    CHECK(sum_of("") == 0);
  }

  TEST_CASE("a sum continues where another ended") {
    const std::string_view whole = "the quick brown fox";
    const auto bytes = std::as_bytes(std::span(whole));
    for (std::size_t cut = 0; cut <= bytes.size(); ++cut)
      CHECK(crc32c(bytes.subspan(cut), crc32c(bytes.first(cut))) == sum_of(whole));
  }
}

} // namespace crc32c_test
