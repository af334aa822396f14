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

/// Returns the count and the noun: "1 face", "2 faces".
inline std::string count_words(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

/// Counts things, and remembers the first one's number, from 1.
struct Tally {
  std::size_t count = 0, first = 0;

  void add(std::size_t number) noexcept {
    if (count++ == 0) first = number;
  }
  /// Returns the words "1 face (face 3) has" or "2 faces (the first is face 3) have".
  std::string words(const std::string& noun, const char* one_does, const char* more_do) const {
    const std::string number = noun + " " + std::to_string(first);
    return std::to_string(count) + " " + noun +
           (count == 1 ? " (" + number + ") " + one_does
                       : "s (the first is " + number + ") " + more_do);
  }
  /// The same, of faces or facets that are left out because they have no area.
  std::string without_three_corners(const std::string& noun) const {
    return words(noun, "has", "have") + " fewer than three different corners and " +
           (count == 1 ? "is" : "are") + " left out";
  }
};

/// Appends the shortest decimals that read back the same.
template <class Number>
void append_number(std::string& text, Number number) {
  std::array<char, 32> digits{}; // a double has at most 24
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text.append(digits.data(), result.ptr);
}

/// Appends each number after a blank.
template <class Numbers>
void append_numbers(std::string& text, const Numbers& numbers) {
  for (const auto number : numbers) {
    text += ' ';
    append_number(text, number);
  }
}

/// As to_number(). An exponent may also begin with D, as Fortran's programs write it: 1.5D+02.
inline std::optional<double> to_number_of_any_program(std::string_view field) noexcept {
  const auto number = to_number(field);
  const std::size_t letter = number ? std::string_view::npos : field.find_first_of("dD");
  std::array<char, 64> digits{}; // more than any double is written with
  if (letter == std::string_view::npos || field.size() > digits.size()) return number;
  std::copy(field.begin(), field.end(), digits.begin());
  digits[letter] = 'e';
  return to_number({digits.data(), field.size()});
}

} // namespace nendo::deform
