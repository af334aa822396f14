#pragma once
// The serial line's capacity, and the interface unit's register for its rate.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace nendo::driver::cyberglove {

/// The rates at which a glove is looked for, likeliest first. Every driver since about 2000 uses
/// 115200; the others are defaults of older units.
inline constexpr std::array usual_bauds{115'200, 38'400, 19'200, 9'600};

/// A byte has a start bit, eight data bits and a stop bit.
inline constexpr double bits_per_byte = 10.0;

/// Returns how many records a second a line can carry.
constexpr double line_limit_hz(int baud, std::size_t record_bytes) noexcept {
  return baud / (bits_per_byte * static_cast<double>(record_bytes));
}

// The byte of 'B' is the BAUD register of the unit's processor, a Motorola 68HC11: bits 5:4 choose
// a prescaler, bits 2:0 a power of two. (The vendor's library masks the byte with 0x37, which is
// just these bits; one driver takes the prescaler from bits 4:3, which fits no such chip.)
inline constexpr int baud_base = 115'200;
inline constexpr unsigned baud_bits = 0x37;

/// Returns the line rate that a register value stands for, rounded; nothing for a byte with other
/// bits.
constexpr std::optional<int> baud_of_register(std::uint8_t byte) noexcept {
  constexpr std::array prescalers{1, 3, 4, 13};
  if ((byte & ~baud_bits) != 0) return std::nullopt;
  const int divisor = prescalers[byte >> 4U & 3U] << (byte & 7U);
  return (baud_base + divisor / 2) / divisor;
}

/// Returns the smallest register value that yields `baud` exactly, if any does.
constexpr std::optional<std::uint8_t> register_of_baud(int baud) noexcept {
  for (unsigned byte = 0; byte <= baud_bits; ++byte) {
    const auto value = baud_of_register(static_cast<std::uint8_t>(byte));
    if (value && *value == baud && baud_base % baud == 0) return static_cast<std::uint8_t>(byte);
  }
  return std::nullopt;
}

} // namespace nendo::driver::cyberglove
