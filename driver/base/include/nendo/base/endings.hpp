#pragma once
// Letters of ASCII without regard to case, as in file name extensions: .OBJ, .Stl.

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

namespace nendo {

/// Returns the lower case of a letter of ASCII, and other characters as they are.
constexpr char to_lower(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

inline std::string to_lower(std::string text) {
  for (char& c : text)
    c = to_lower(c);
  return text;
}

/// Returns whether `path` ends in `ending` (lower case, e.g. ".obj"), ignoring ASCII case.
constexpr bool ends_in(std::string_view path, std::string_view ending) noexcept {
  const auto same = [](char in_path, char in_ending) { return to_lower(in_path) == in_ending; };
  return path.size() >= ending.size() &&
         std::equal(path.end() - static_cast<std::ptrdiff_t>(ending.size()), path.end(),
                    ending.begin(), same);
}

/// Returns the first of `endings` in which `path` ends; empty if there is none.
constexpr std::string_view ending_of(std::string_view path,
                                     std::span<const std::string_view> endings) noexcept {
  for (const std::string_view ending : endings)
    if (ends_in(path, ending)) return ending;
  return {};
}

} // namespace nendo
