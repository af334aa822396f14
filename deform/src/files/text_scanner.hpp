#pragma once
// Splits text into lines and fields without copies, so that long lines cost nothing extra.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace nendo::deform {

/// The largest size in bytes of a file of a mesh or of control vectors.
inline constexpr std::uint64_t max_file_bytes = std::uint64_t{4} << 30;

/// Walks over a text field by field. Fields are separated by blanks, and are views into the text. A
/// line ends with \n, with \r\n, or, as on old Macintoshes, with \r.
class TextScanner {
public:
  enum class Dialect {
    plain,
    obj ///< a backslash at the end of a line continues it, also before blanks; # begins a comment
  };
  TextScanner(std::string_view text, Dialect dialect) noexcept : text_(text), dialect_(dialect) {}

  /// Returns the next field of this line; empty at the end of the line.
  std::string_view field() noexcept;
  /// Returns the next field of this line, or the first field of a later line; empty at the end of
  /// the text.
  std::string_view field_on_any_line() noexcept;
  /// Returns what is left of this line, a comment too, and does not continue.
  std::string_view rest_of_line() const noexcept;
  /// Goes to the start of the next line; returns false at the end of the text.
  bool next_line() noexcept;

  /// Returns the number of this line, from 1, and the offset of the next character in the text.
  std::size_t line() const noexcept { return line_; }
  std::size_t offset() const noexcept { return at_; }

private:
  std::size_t line_end_length(std::size_t at) const noexcept;
  std::size_t continuation_length() const noexcept;

  std::string_view text_;
  Dialect dialect_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

/// Returns the other fields of this line, with one blank between two: a name that may have blanks.
std::string joined_fields(TextScanner& scanner);

} // namespace nendo::deform
