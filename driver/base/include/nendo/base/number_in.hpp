#pragma once
// Numbers that users and devices write.

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace nendo {

/// Returns the number that is all of the text, without a plus sign or blanks. `form` is as in
/// std::from_chars(). "nan" and "inf" are numbers: compare with bounds.
template <class Number, class... Form>
std::optional<Number> number_in(std::string_view text, Form... form) noexcept {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number, form...);
  if (error != std::errc{} || stopped != end) return std::nullopt;
  return number;
}

} // namespace nendo
