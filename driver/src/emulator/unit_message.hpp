#pragma once
// Bytes and numbers as the interface unit's messages hold them, and the shape of its commands.

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace nendo::driver::unit {

using Byte = std::uint8_t;
using Message = std::vector<Byte>;

constexpr bool is_lower(Byte letter) noexcept {
  return letter >= 'a' && letter <= 'z';
}
constexpr Byte to_upper(Byte letter) noexcept {
  return is_lower(letter) ? static_cast<Byte>(letter - 'a' + 'A') : letter;
}

inline void append(Message& message, std::string_view text) {
  for (const char c : text)
    message.push_back(static_cast<Byte>(c));
}

// Least significant byte first, as masks, parameter flags and the time stamp go.
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

constexpr std::uint16_t high_first(Byte high, Byte low) noexcept {
  return static_cast<std::uint16_t>((high << 8) | low);
}

// What a command that sets something takes: so many numbers of so many bytes. Its lower-case letter
// takes the same numbers as text.
struct Arguments {
  std::size_t numbers; // 0: there is no such command
  std::size_t width;
};
constexpr Arguments arguments_of(Byte letter) noexcept {
  switch (to_upper(letter)) {
  case 'T':
    return {2, 2};
  case 'M':
  case 'P':
    return {3, 1};
  case 'B':
  case 'D':
  case 'F':
  case 'J':
  case 'L':
  case 'N':
  case 'Q':
  case 'U':
  case 'W':
    return {1, 1};
  default:
    return {0, 0};
  }
}

// The numbers of a text command as bytes, each `width` bytes wide and high byte first; empty if
// they are not exactly `count` numbers that fit.
inline Message read_numbers(const Message& text, std::size_t count, std::size_t width) {
  const std::string line(text.begin(), text.end());
  const char* at = line.data();
  const char* const end = at + line.size();
  Message bytes;
  for (;;) {
    at = std::find_if(at, end, [](char c) { return c != ' '; });
    if (at == end) break;
    std::uint32_t number = 0;
    const auto [stopped, error] = std::from_chars(at, end, number);
    if (error != std::errc{} || (stopped != end && *stopped != ' ')) return {};
    if (number >= 1U << (8 * width)) return {};
    if (width == 2) bytes.push_back(static_cast<Byte>(number >> 8));
    bytes.push_back(static_cast<Byte>(number));
    at = stopped;
  }
  if (bytes.size() != count * width) bytes.clear();
  return bytes;
}

} // namespace nendo::driver::unit
