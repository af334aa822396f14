#include <nendo/base/text.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include <nendo/base/number_in.hpp>

namespace nendo {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

template <class Number>
std::optional<Number> parse_whole(std::string_view field) noexcept {
  // from_chars knows no plus sign; "+-1" must not slip through.
  if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
  return number_in<Number>(field);
}

/// What the first byte of a character says of it.
struct Utf8Length {
  std::size_t following; ///< bytes
  std::uint32_t least;   ///< the least code point that needs so many bytes
  std::uint32_t bits;    ///< those of the code point in the first byte
};

std::optional<Utf8Length> utf8_length(unsigned char first) noexcept {
  if (first < 0x80) return Utf8Length{0, 0, first};
  if (first >= 0xC2 && first < 0xE0) return Utf8Length{1, 0x80, first & 0x1FU};
  if (first >= 0xE0 && first < 0xF0) return Utf8Length{2, 0x800, first & 0x0FU};
  if (first >= 0xF0 && first < 0xF5) return Utf8Length{3, 0x10000, first & 0x07U};
  return std::nullopt;
}

} // namespace

std::string_view without_mark(std::string_view text) noexcept {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  return text;
}

std::optional<std::string_view> LineReader::next() noexcept {
  while (!rest_.empty()) {
    ++line_;
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    const std::string_view line = trimmed(rest_.substr(0, end));
    const std::size_t ending = rest_.substr(end).starts_with("\r\n") ? 2 : 1;
    rest_.remove_prefix(std::min(end + ending, rest_.size()));
    if (!line.empty()) return line;
  }
  return std::nullopt;
}

std::string_view trimmed(std::string_view text) noexcept {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::string_view cut(std::string_view& rest, char separator) noexcept {
  const std::size_t at = std::min(rest.find(separator), rest.size());
  const std::string_view part = rest.substr(0, at);
  rest.remove_prefix(std::min(at + 1, rest.size()));
  return part;
}

std::string_view ItemReader::next() noexcept {
  if (has_ended_) return {};
  has_ended_ = rest_.find(separator_) == std::string_view::npos;
  return cut(rest_, separator_);
}

std::vector<std::string_view> fields_of(std::string_view line, std::size_t most) {
  std::vector<std::string_view> fields;
  while (fields.size() < most) {
    line = trimmed(line);
    if (line.empty()) break;
    const std::size_t end = std::min(line.find_first_of(blanks), line.size());
    fields.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return fields;
}

std::optional<double> to_number(std::string_view field) noexcept {
  return parse_whole<double>(field);
}

std::optional<double> to_finite_number(std::string_view field) noexcept {
  const auto number = to_number(field);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<double> to_metres(std::string_view field) noexcept {
  double unit_m = 1.0;
  if (!field.ends_with('m')) return std::nullopt;
  field.remove_suffix(1);
  if (field.ends_with('m') || field.ends_with('c')) {
    unit_m = field.ends_with('m') ? 1e-3 : 1e-2;
    field.remove_suffix(1);
  }
  const auto number = to_finite_number(field);
  return number ? std::optional(*number * unit_m) : std::nullopt;
}

std::optional<std::int64_t> to_integer(std::string_view field) noexcept {
  return parse_whole<std::int64_t>(field);
}

std::string decimal_text(double value) {
  std::array<char, 40> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  std::string text(digits.data(), end);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string printable(std::string_view text) {
  std::string shown(text);
  std::replace_if(shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t most = 40;
  return "'" + printable(text.substr(0, most)) + (text.size() > most ? "...'" : "'");
}

bool is_utf8(std::string_view text) noexcept {
  for (std::size_t at = 0; at < text.size();) {
    const auto length = utf8_length(static_cast<unsigned char>(text[at++]));
    if (!length || text.size() - at < length->following) return false;
    std::uint32_t point = length->bits;
    for (std::size_t k = 0; k < length->following; ++k) {
      const auto byte = static_cast<unsigned char>(text[at++]);
      if ((byte & 0xC0U) != 0x80U) return false;
      point = (point << 6U) | (byte & 0x3FU);
    }
    const bool surrogate = point >= 0xD800 && point < 0xE000;
    if (point < length->least || point > 0x10FFFF || surrogate) return false;
  }
  return true;
}

Error bad_line(std::string_view name, std::size_t line, const std::string& what) {
  return {Errc::bad_input, std::string(name) + ":" + std::to_string(line) + ": " + what};
}

} // namespace nendo
