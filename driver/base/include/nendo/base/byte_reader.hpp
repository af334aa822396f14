#pragma once
// Reads bytes one after another and checks bounds. A read past the end yields zeros and sets a flag
// that stays set, so that a decoder reads a whole layout and asks once, at the end, whether there
// were enough bytes.

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
  /// Reads a text as ByteWriter::text() writes it; it may hold any bytes. The view is valid as long
  /// as the bytes that are read.
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
  /// Returns true if any read so far went past the end.
  [[nodiscard]] constexpr bool overrun() const noexcept { return overrun_; }

private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool overrun_ = false;
};

} // namespace nendo
