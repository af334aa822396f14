#pragma once
// A left or right hand.

#include <cstdint>
#include <optional>
#include <string_view>

namespace nendo {

enum class Side : std::uint8_t { left, right };

constexpr Side opposite(Side side) noexcept {
  return side == Side::left ? Side::right : Side::left;
}

/// Returns "left" or "right", as in options, files and udev rules.
constexpr std::string_view name_of(Side side) noexcept {
  return side == Side::left ? "left" : "right";
}
constexpr std::optional<Side> side_named(std::string_view name) noexcept {
  for (const Side side : {Side::left, Side::right})
    if (name == name_of(side)) return side;
  return std::nullopt;
}

} // namespace nendo
