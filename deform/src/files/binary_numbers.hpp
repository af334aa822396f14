#pragma once
// Numbers in the bytes of files.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

namespace nendo::deform {

/// Returns the number that begins at `bytes`.
template <class Number>
Number number_from(const char* bytes, std::endian order = std::endian::little) noexcept {
  std::array<char, sizeof(Number)> ordered{};
  std::copy_n(bytes, sizeof(Number), ordered.begin());
  if (order != std::endian::native) std::reverse(ordered.begin(), ordered.end());
  return std::bit_cast<Number>(ordered);
}

enum class NumberType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::size_t size_of(NumberType type) noexcept {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

/// Returns the number of this type that begins at `bytes`; a double holds each of them exactly.
inline double number_from(NumberType type, const char* bytes,
                          std::endian order = std::endian::little) noexcept {
  switch (type) {
  case NumberType::int8:
    return number_from<std::int8_t>(bytes, order);
  case NumberType::uint8:
    return number_from<std::uint8_t>(bytes, order);
  case NumberType::int16:
    return number_from<std::int16_t>(bytes, order);
  case NumberType::uint16:
    return number_from<std::uint16_t>(bytes, order);
  case NumberType::int32:
    return number_from<std::int32_t>(bytes, order);
  case NumberType::uint32:
    return number_from<std::uint32_t>(bytes, order);
  case NumberType::float32:
    return static_cast<double>(number_from<float>(bytes, order));
  case NumberType::float64:
    break;
  }
  return number_from<double>(bytes, order);
}

/// Appends a number, least significant byte first.
template <class Number>
void append_little_endian(std::string& bytes, Number number) {
  auto ordered = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  if (std::endian::native == std::endian::big) std::reverse(ordered.begin(), ordered.end());
  bytes.append(ordered.data(), ordered.size());
}

} // namespace nendo::deform
