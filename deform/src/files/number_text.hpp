#pragma once
// Numbers as text.

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/text.hpp>

namespace nendo::deform {

/// Appends the shortest decimals that read back the same.
template <class Number>
void append_number(std::string& text, Number number) {
  std::array<char, 32> digits{}; // a double has at most 24
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text.append(digits.data(), result.ptr);
}

/// As to_number(). An exponent may also begin with D, as Fortran's programs write it: 1.5D+02.
inline std::optional<double> to_number_of_any_program(std::string_view field) noexcept {
  const auto number = to_number(field);
  const std::size_t letter = number ? field.npos : field.find_first_of("dD");
  std::array<char, 64> digits{}; // more than any double is written with
  if (letter == field.npos || field.size() > digits.size()) return number;
  std::copy(field.begin(), field.end(), digits.begin());
  digits[letter] = 'e';
  return to_number({digits.data(), field.size()});
}

} // namespace nendo::deform
