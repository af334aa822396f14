#pragma once
// Endings of files' names. People write them in either case: .OBJ, .Stl.

#include <algorithm>
#include <span>
#include <string_view>

namespace nendo {

/// Returns whether the path ends in `ending` (".obj", in small letters), in any case.
constexpr bool ends_in(std::string_view path, std::string_view ending) noexcept {
  const auto same = [](char in_path, char in_ending) {
    const char small =
        in_path >= 'A' && in_path <= 'Z' ? static_cast<char>(in_path - 'A' + 'a') : in_path;
    return small == in_ending;
  };
  return path.size() >= ending.size() &&
         std::equal(path.end() - static_cast<std::ptrdiff_t>(ending.size()), path.end(),
                    ending.begin(), same);
}

/// Returns that of the endings in which the path ends; empty if it ends in none of them.
constexpr std::string_view ending_of(std::string_view path,
                                     std::span<const std::string_view> endings) noexcept {
  for (const std::string_view ending : endings)
    if (ends_in(path, ending)) return ending;
  return {};
}

} // namespace nendo
