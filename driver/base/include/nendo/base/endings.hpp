#pragma once
// File name extensions, compared without regard to case: .OBJ, .Stl.

#include <algorithm>
#include <span>
#include <string_view>

namespace nendo {

/// Returns whether `path` ends in `ending` (lower case, e.g. ".obj"), ignoring ASCII case.
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

/// Returns the first of `endings` in which `path` ends; empty if there is none.
constexpr std::string_view ending_of(std::string_view path,
                                     std::span<const std::string_view> endings) noexcept {
  for (const std::string_view ending : endings)
    if (ends_in(path, ending)) return ending;
  return {};
}

} // namespace nendo
