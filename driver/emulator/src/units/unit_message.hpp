#pragma once
// Functions for the bytes and numbers of the interface unit's messages.

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <vector>

namespace nendo::emulator::unit {

using Byte = std::uint8_t;
using Message = std::vector<Byte>;

constexpr bool is_lower(Byte letter) noexcept {
  return letter >= 'a' && letter <= 'z';
}
constexpr Byte to_upper(Byte letter) noexcept {
  return is_lower(letter) ? static_cast<Byte>(letter - 'a' + 'A') : letter;
}
constexpr Byte to_lower(Byte letter) noexcept {
  return letter >= 'A' && letter <= 'Z' ? static_cast<Byte>(letter - 'A' + 'a') : letter;
}

inline void append(Message& message, std::string_view text) {
  for (const char c : text)
    message.push_back(static_cast<Byte>(c));
}

// Returns the bytes of `value`, least significant first, as masks, parameter flags and the time
// stamp have them.
inline Message low_first(std::uint32_t value, unsigned bytes) {
  Message message;
  for (unsigned k = 0; k < bytes; ++k)
    message.push_back(static_cast<Byte>(value >> (8 * k)));
  return message;
}

inline std::uint32_t from_low_first(const Message& bytes) noexcept {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < bytes.size(); ++k)
    value |= static_cast<std::uint32_t>(bytes[k]) << (8 * k);
  return value;
}

// Returns the decimal numbers of a text command as bytes, each `width` bytes wide, high byte first.
// Returns an empty message if there is no number, anything else, or a number that does not fit.
inline Message read_numbers(std::string_view text, std::size_t width) {
  const char* at = text.data();
  const char* const end = at + text.size();
  Message bytes;
  for (;;) {
    at = std::find_if(at, end, [](char c) { return c != ' '; });
    if (at == end) return bytes;
    std::uint32_t number = 0;
    const auto [stopped, error] = std::from_chars(at, end, number);
    if (error != std::errc{} || (stopped != end && *stopped != ' ')) return {};
    if (number >= 1U << (8 * width)) return {};
    if (width == 2) bytes.push_back(static_cast<Byte>(number >> 8));
    bytes.push_back(static_cast<Byte>(number));
    at = stopped;
  }
}

} // namespace nendo::emulator::unit
