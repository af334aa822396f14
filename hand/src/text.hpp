#pragma once
// Text of unknown origin: lines, fields and numbers, the same in every locale; and errors that name
// a place in it.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::hand {

/// Of a file of any form that holds one.
inline constexpr std::uint64_t most_calibration_bytes = std::uint64_t{1} << 20;

/// Numbers the lines that it hands out, from 1, without blanks at their ends.
class LineReader {
public:
  explicit LineReader(std::string_view text) noexcept : rest_(text) {}
  /// The next line that is not empty; nullopt at the end.
  std::optional<std::string_view> next() noexcept;
  std::size_t line() const noexcept { return line_; }

private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

std::string_view trimmed(std::string_view text) noexcept;
/// Cuts the part before the first `separator` off `rest`.
std::string_view cut(std::string_view& rest, char separator) noexcept;
/// The fields between blanks, at most so many of them.
std::vector<std::string_view> fields_of(std::string_view line, std::size_t most = 16);
/// The whole field as a finite number, or nothing. A leading plus sign is allowed.
std::optional<double> to_number(std::string_view field) noexcept;
/// The shortest decimals that read back to the same double; `value` is finite.
std::string number_text(double value);

/// For a message: in quotes, shortened, without control characters.
std::string in_quotes(std::string_view text); // std::quoted would be found for strings
bool is_utf8(std::string_view text) noexcept;
Error bad_line(std::string_view name, std::size_t line, const std::string& what);

} // namespace nendo::hand
