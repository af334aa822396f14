#pragma once
// Numbers in the bytes of files.

#include <algorithm>
#include <array>
#include <bit>
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

/// Appends a number, least significant byte first.
template <class Number>
void append_little_endian(std::string& bytes, Number number) {
  auto ordered = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  if (std::endian::native == std::endian::big) std::reverse(ordered.begin(), ordered.end());
  bytes.append(ordered.data(), ordered.size());
}

} // namespace nendo::deform
