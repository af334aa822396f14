#pragma once
// Appends little-endian and big-endian numbers, and strings, to a vector, for ByteReader to read.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace nendo {

class ByteWriter {
public:
  /// Appends to `out`, which must outlive the writer.
  explicit ByteWriter(std::vector<std::byte>& out) noexcept : out_(&out) {}

  void u8(std::uint8_t value) { out_->push_back(std::byte{value}); }
  void u16_le(std::uint16_t value) { put(value, 2); }
  void u32_le(std::uint32_t value) { put(value, 4); }
  void u64_le(std::uint64_t value) { put(value, 8); }
  void i64_le(std::int64_t value) { u64_le(std::bit_cast<std::uint64_t>(value)); }
  void f64_le(double value) { u64_le(std::bit_cast<std::uint64_t>(value)); }
  void u32_be(std::uint32_t value) {
    for (const unsigned shift : {24U, 16U, 8U, 0U})
      u8(static_cast<std::uint8_t>(value >> shift));
  }
  void f64_be(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    u32_be(static_cast<std::uint32_t>(bits >> 32U));
    u32_be(static_cast<std::uint32_t>(bits));
  }
  void bytes(std::span<const std::byte> part) {
    out_->insert(out_->end(), part.begin(), part.end());
  }
  /// Writes a 16-bit length and then the string, truncated to 65535 bytes.
  void text(std::string_view part) {
    part = part.substr(0, UINT16_MAX);
    u16_le(static_cast<std::uint16_t>(part.size()));
    bytes(std::as_bytes(std::span(part)));
  }

private:
  void put(std::uint64_t value, unsigned count) {
    for (unsigned at = 0; at < count; ++at, value >>= 8U)
      out_->push_back(static_cast<std::byte>(value & 0xFFU));
  }

  std::vector<std::byte>* out_;
};

} // namespace nendo
