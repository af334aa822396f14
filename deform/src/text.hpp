#pragma once
// Text of unknown origin: lines, blank-separated fields and numbers, the same in every locale and
// without copies, so that the length of a line costs nothing. And the errors that name a place in
// such a text.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::deform {

/// Of a mesh or of control vectors.
inline constexpr std::uint64_t most_file_bytes = std::uint64_t{4} << 30;

/// The whole field as a number, or nothing. A leading plus sign is allowed; NaN and infinity come
/// through.
std::optional<double> to_number(std::string_view field) noexcept;
std::optional<std::int64_t> to_integer(std::string_view field) noexcept;

/// A field for an error message: in quotes, shortened, without control characters.
std::string quoted(std::string_view field);
Error bad_line(std::string_view name, std::size_t line, const std::string& what);

class TextScanner {
public:
  enum class Dialect {
    plain,
    obj ///< a backslash at its end continues a line, # begins a comment
  };
  TextScanner(std::string_view text, Dialect dialect) noexcept : text_(text), dialect_(dialect) {}

  /// The next field of this line; empty at its end.
  std::string_view field() noexcept;
  /// The next field of this line or the first of a later one; empty at the end of the text.
  std::string_view field_on_any_line() noexcept;
  /// Goes to the start of the next line; false at the end of the text.
  bool next_line() noexcept;

  std::size_t line() const noexcept { return line_; }
  std::size_t offset() const noexcept { return at_; }

private:
  std::size_t continuation_length() const noexcept;

  std::string_view text_;
  Dialect dialect_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

} // namespace nendo::deform
