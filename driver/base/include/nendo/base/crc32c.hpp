#pragma once
// CRC-32C (Castagnoli) is the checksum of iSCSI (RFC 3720, appendix B.4) and of many file formats.
// It detects every burst error of up to 32 bits, and all but one in 2^32 of longer ones.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace nendo {
namespace detail {

constexpr std::array<std::uint32_t, 256> crc32c_table() noexcept {
  constexpr std::uint32_t reversed_polynomial = 0x82F63B78;
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? reversed_polynomial : 0U);
    table[byte] = crc;
  }
  return table;
}

inline constexpr auto crc32c_bytes = crc32c_table();

} // namespace detail

/// Returns the checksum of `bytes`, continued from `before`, the checksum of the preceding bytes.
/// Pure and async-signal-safe.
constexpr std::uint32_t crc32c(std::span<const std::byte> bytes,
                               std::uint32_t before = 0) noexcept {
  std::uint32_t crc = ~before;
  for (const std::byte byte : bytes)
    crc = (crc >> 8U) ^ detail::crc32c_bytes[(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  return ~crc;
}

} // namespace nendo
