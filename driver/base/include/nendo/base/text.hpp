#pragma once
// Helpers for text of unknown origin (files, command lines, answers of devices): lines, fields,
// numbers, and errors that name a place in a text. They behave the same in every locale. Views that
// they return point into the text that was given. None of them throws anything but
// std::bad_alloc.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo {

/// Returns the text without the byte-order mark of UTF-8 that some programs put before it.
NENDO_API std::string_view without_mark(std::string_view text) noexcept;

/// Hands out the lines of a text one by one, without blanks at their ends. A line ends with \n,
/// with
/// \r\n, or, as on old Macintoshes, with \r. A byte-order mark is skipped.
class NENDO_API LineReader {
public:
  explicit LineReader(std::string_view text) noexcept : rest_(without_mark(text)) {}
  /// Returns the next line that is not empty, or nullopt at the end of the text.
  std::optional<std::string_view> next() noexcept;
  /// Returns the number of the line that next() returned last; the first line has number 1.
  std::size_t line() const noexcept { return line_; }

private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

/// Returns the text without blanks at its ends. Blanks are space, \t, \r, \v and \f.
NENDO_API std::string_view trimmed(std::string_view text) noexcept;

/// Removes the part before the first `separator`, and the separator, from `rest` and returns that
/// part. Without a separator, the whole text is the part and `rest` becomes empty.
NENDO_API std::string_view cut(std::string_view& rest, char separator) noexcept;

/// Returns the fields of a line that blanks separate, at most `most` of them.
NENDO_API std::vector<std::string_view> fields_of(std::string_view line, std::size_t most = 16);

/// Returns the number that the whole field is, or nullopt. A leading plus sign is allowed. "nan"
/// and "inf" are numbers; use to_finite_number() where they are not wanted.
NENDO_API std::optional<double> to_number(std::string_view field) noexcept;
NENDO_API std::optional<double> to_finite_number(std::string_view field) noexcept;
/// Returns the metres of "5mm", "1.8cm" or "0.2m". Nothing if the field is no finite length, or has
/// no unit: a bare number has another meaning for each reader.
NENDO_API std::optional<double> to_metres(std::string_view field) noexcept;
NENDO_API std::optional<std::int64_t> to_integer(std::string_view field) noexcept;

/// Returns the shortest decimals that read back to the same double. They have a point or an
/// exponent, as TOML wants it of a float. `value` must be finite.
NENDO_API std::string decimal_text(double value);

/// Returns the text with '?' in place of everything but printable ASCII, so that no escape sequence
/// reaches a terminal.
NENDO_API std::string printable(std::string_view text);

/// Returns the text for a message: printable, in single quotes, cut after 40 characters.
NENDO_API std::string in_quotes(std::string_view text);

/// Returns whether the text is well-formed UTF-8: no overlong forms, no surrogates, nothing beyond
/// U+10FFFF.
NENDO_API bool is_utf8(std::string_view text) noexcept;

/// Returns an Error of kind bad_input whose message is "name:line: what".
NENDO_API Error bad_line(std::string_view name, std::size_t line, const std::string& what);

} // namespace nendo
