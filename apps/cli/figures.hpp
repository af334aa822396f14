#pragma once
// Strings of numbers and lists in messages.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/figures.hpp>

namespace nendo::cli {

/// Returns the number with this count of decimals.
std::string fixed(double number, int decimals);
/// Returns the whole part of a number, with a comma after each three digits: "5,000".
template <class Number>
std::string thousands(Number number) {
  return nendo::thousands(static_cast<std::int64_t>(number));
}
/// Returns "1 link" or "2 links".
std::string count_text(std::size_t count, std::string_view word);
/// Returns the words with separators between them.
std::string joined(std::span<const std::string> words, std::string_view separator = ", ");

} // namespace nendo::cli
