#pragma once
// Helpers for untrusted text (files, command lines, replies of devices): lines, fields, numbers,
// and errors with line numbers. They do not depend on the locale. Returned views point into the
// argument. They throw nothing but std::bad_alloc.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo {

/// Returns the text without a leading UTF-8 byte-order mark.
NENDO_API std::string_view without_mark(std::string_view text) noexcept;

/// Iterates over the lines of a text, trimmed of blanks. A line ends with \n, \r\n or \r. A
/// byte-order mark is skipped.
class NENDO_API LineReader {
public:
  explicit LineReader(std::string_view text) noexcept : rest_(without_mark(text)) {}
  /// Returns the next line that is not empty, or nullopt at the end of the text.
  std::optional<std::string_view> next() noexcept;
  /// Returns the number of the last returned line, counted from 1.
  std::size_t line() const noexcept { return line_; }

private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

/// Returns the text without leading and trailing blanks: space, \t, \r, \v and \f.
NENDO_API std::string_view trimmed(std::string_view text) noexcept;

/// Returns the part of `rest` before the first `separator`, and removes both from `rest`. Without a
/// separator, returns all of `rest`, which becomes empty.
NENDO_API std::string_view cut(std::string_view& rest, char separator) noexcept;

/// Iterates over the items of a text that single separators divide. "a,,b" has an empty item, and
/// an empty text is one.
class NENDO_API ItemReader {
public:
  ItemReader(std::string_view text, char separator) noexcept : rest_(text), separator_(separator) {}
  /// Returns the next item; empty at the end.
  std::string_view next() noexcept;
  bool has_ended() const noexcept { return has_ended_; }

private:
  std::string_view rest_;
  char separator_;
  bool has_ended_ = false;
};

/// Returns the first `most` fields of a line, separated by blanks.
NENDO_API std::vector<std::string_view> fields_of(std::string_view line, std::size_t most = 16);

/// Parses the whole field as a number; nullopt if it is none. A leading plus sign is allowed. "nan"
/// and "inf" are accepted; to_finite_number() rejects them.
NENDO_API std::optional<double> to_number(std::string_view field) noexcept;
NENDO_API std::optional<double> to_finite_number(std::string_view field) noexcept;
/// Parses a length with a unit ("5mm", "1.8cm", "0.2m") to metres. Returns nullopt if it is not
/// finite or has no unit, because a bare number would be ambiguous.
NENDO_API std::optional<double> to_metres(std::string_view field) noexcept;
NENDO_API std::optional<std::int64_t> to_integer(std::string_view field) noexcept;

/// Returns the enumerator of this name. `names` are in the order of the enumerators, the first of
/// which is 0.
template <class Enum, class Names>
constexpr std::optional<Enum> enumerator_named(const Names& names, std::string_view name) noexcept {
  for (std::size_t at = 0; at < names.size(); ++at)
    if (names[at] == name) return static_cast<Enum>(at);
  return std::nullopt;
}

/// Returns the shortest decimal string that parses to the same double. It has a point or an
/// exponent, as TOML requires of a float. `value` must be finite.
NENDO_API std::string decimal_text(double value);

/// Replaces all bytes but printable ASCII by '?', so that no escape sequence reaches a terminal.
NENDO_API std::string printable(std::string_view text);

/// Returns the text for a message: printable, in single quotes, cut after 40 characters.
NENDO_API std::string in_quotes(std::string_view text);

/// Returns whether the text is well-formed UTF-8: no overlong forms, no surrogates, nothing beyond
/// U+10FFFF.
NENDO_API bool is_utf8(std::string_view text) noexcept;

/// Returns an Error of kind bad_input whose message is "name:line: what".
NENDO_API Error bad_line(std::string_view name, std::size_t line, const std::string& what);

} // namespace nendo
