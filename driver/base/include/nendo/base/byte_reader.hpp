#pragma once
// Reads little-endian and big-endian values from a span, with bounds checks. Bytes past the end
// read as zero and set a sticky flag, overrun(), so that a decoder can read a whole layout and
// check once at the end.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace nendo {

class ByteReader {
public:
  explicit constexpr ByteReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  constexpr std::uint8_t u8() noexcept {
    if (position_ >= bytes_.size()) {
      overrun_ = true;
      return 0;
    }
    return std::to_integer<std::uint8_t>(bytes_[position_++]);
  }
  constexpr std::uint16_t u16_le() noexcept {
    const unsigned low = u8();
    return static_cast<std::uint16_t>(low | (static_cast<unsigned>(u8()) << 8U));
  }
  constexpr std::uint32_t u24_le() noexcept {
    const std::uint32_t low = u16_le();
    return low | (static_cast<std::uint32_t>(u8()) << 16U);
  }
  constexpr std::uint32_t u32_le() noexcept {
    const std::uint32_t low = u16_le();
    return low | (static_cast<std::uint32_t>(u16_le()) << 16U);
  }
  constexpr std::uint64_t u64_le() noexcept {
    const std::uint64_t low = u32_le();
    return low | (static_cast<std::uint64_t>(u32_le()) << 32U);
  }
  constexpr std::int64_t i64_le() noexcept { return std::bit_cast<std::int64_t>(u64_le()); }
  constexpr double f64_le() noexcept { return std::bit_cast<double>(u64_le()); }
  constexpr std::uint32_t u32_be() noexcept {
    std::uint32_t value = 0;
    for (int byte = 0; byte < 4; ++byte)
      value = value << 8U | u8();
    return value;
  }
  constexpr std::int32_t i32_be() noexcept { return std::bit_cast<std::int32_t>(u32_be()); }
  constexpr std::uint64_t u64_be() noexcept {
    const std::uint64_t high = u32_be();
    return high << 32U | u32_be();
  }
  constexpr double f64_be() noexcept { return std::bit_cast<double>(u64_be()); }
  /// Reads a string that ByteWriter::text() wrote; it may hold any bytes. The view points into the
  /// input.
  std::string_view text() noexcept {
    const auto part = take(u16_le());
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }
  constexpr std::span<const std::byte> take(std::size_t count) noexcept {
    if (count > remaining()) {
      overrun_ = true;
      count = remaining();
    }
    const auto part = bytes_.subspan(position_, count);
    position_ += count;
    return part;
  }

  [[nodiscard]] constexpr std::size_t remaining() const noexcept {
    return bytes_.size() - position_;
  }
  /// Returns true if any read went past the end.
  [[nodiscard]] constexpr bool overrun() const noexcept { return overrun_; }

private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool overrun_ = false;
};

} // namespace nendo
