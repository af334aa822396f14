#pragma once
// Numbers in text.

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

namespace nendo::driver {

/// Returns the number that is all of the text, if it is finite.
inline std::optional<double> decimal_of(std::string_view text) noexcept {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stopped, failure] = std::from_chars(text.data(), end, number);
  if (failure != std::errc{} || stopped != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

} // namespace nendo::driver
