#pragma once
// Numbers as text.

#include <array>
#include <charconv>
#include <string>

namespace nendo::deform {

/// Appends the shortest decimals that read back the same.
template <class Number>
void append_number(std::string& text, Number number) {
  std::array<char, 32> digits{}; // a double has at most 24
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text.append(digits.data(), result.ptr);
}

} // namespace nendo::deform
