#include <nendo/base/table.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>

namespace nendo {
namespace {

constexpr std::string_view line_ends = "\r\n";

bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

std::string_view first_line(std::string_view text) noexcept {
  return text.substr(0, std::min(text.find_first_of(line_ends), text.size()));
}

std::size_t length_of_line_end(std::string_view text) noexcept {
  return text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1;
}

/// Returns whether `c` occurs in the line outside of quotes. A tab beside a comma or a semicolon is
/// a blank that follows it.
bool separates(std::string_view line, char c) noexcept {
  bool is_quoted = false;
  char before = '\0'; // the last character that is no blank
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (line[at] == '"') is_quoted = !is_quoted;
    if (!is_quoted && line[at] == c) {
      if (c != '\t') return true;
      const std::size_t next = std::min(line.find_first_not_of(" \t", at), line.size());
      const char after = next < line.size() ? line[next] : '\0';
      const auto ends = [](char end) { return end == ',' || end == ';'; };
      if (!ends(before) && !ends(after)) return true;
    }
    if (!is_blank(line[at])) before = line[at];
  }
  return false;
}

char separator_of(std::string_view line) noexcept {
  for (const char c : {'\t', ';', ','})
    if (separates(line, c)) return c;
  return ' ';
}

/// Excel's own line about the separator.
std::optional<char> stated_separator(std::string_view line) noexcept {
  line = trimmed(line);
  if (line.size() > 1 && line.front() == '"' && line.back() == '"')
    line = line.substr(1, line.size() - 2);
  if (line.size() != 5 || line.substr(1, 3) != "ep=" || to_lower(line[0]) != 's')
    return std::nullopt;
  const char c = line[4];
  return c == ',' || c == ';' ? std::optional(c) : std::nullopt;
}

bool is_word_for_nothing(std::string_view cell) noexcept {
  constexpr std::array<std::string_view, 6> words{"", "nan", "na", "n/a", "null", "none"};
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    return std::equal(word.begin(), word.end(), cell.begin(), cell.end(),
                      [](char a, char b) { return a == to_lower(b); });
  });
}

/// The cell with a point in place of a decimal comma.
std::string with_point(std::string_view cell) {
  std::string text(cell);
  if (std::count(text.begin(), text.end(), ',') == 1 && text.find('.') == std::string::npos)
    text[text.find(',')] = '.';
  return text;
}

bool is_number_cell(std::string_view cell) {
  return to_number(with_point(cell)).has_value();
}

} // namespace

TableReader::TableReader(std::string_view text, std::string name)
    : rest_(without_mark(text)), name_(std::move(name)) {}

Error TableReader::bad(const std::string& what) const {
  return bad_line(name_, std::max<std::size_t>(line_, 1), what);
}

Error TableReader::bad_cell(std::size_t column, const std::string& what) const {
  std::string place = "column " + std::to_string(column + 1);
  if (column < names_.size() && !names_[column].empty())
    place += " (" + printable(std::string_view(names_[column]).substr(0, 40)) + ")";
  return bad(place + ": " + in_quotes(cells_[column]) + " " + what);
}

std::string TableReader::plain(std::string_view name) {
  std::string result;
  bool is_between = false;
  for (const char c : trimmed(name)) {
    const bool is_mute = static_cast<unsigned char>(c) <= ' '; // line ends within quotes, too
    if (is_mute || std::string_view("()[]{}/-_").find(c) != std::string_view::npos) {
      is_between = !result.empty();
      continue;
    }
    if (std::exchange(is_between, false)) result += '_';
    result += to_lower(c);
  }
  return result;
}

bool TableReader::is_padding(char c) const noexcept {
  return is_blank(c) && (separator_ == ' ' || c != separator_);
}

bool TableReader::is_separator(char c) const noexcept {
  if (separator_ == ' ') return is_blank(c);
  return c == separator_ || (blanks_too_ && is_blank(c));
}

Result<void> TableReader::check_is_text() const {
  const auto is_no_table = [&](const std::string& what) {
    return Error{Errc::bad_input, name_ + ": is " + what + "; save it as CSV in UTF-8"};
  };
  if (rest_.starts_with("\xFF\xFE") || rest_.starts_with("\xFE\xFF")) return is_no_table("UTF-16");
  if (rest_.starts_with("PK\x03\x04")) return is_no_table("a spreadsheet or an archive, no text");
  if (rest_.starts_with("\x1F\x8B")) return is_no_table("compressed by gzip, no text");
  return {};
}

bool TableReader::skip_line() {
  const std::string_view line = first_line(rest_);
  const std::string_view content = trimmed(line);
  const bool is_comment = content.starts_with('#');
  const auto stated = separator_ == '\0' ? stated_separator(content) : std::nullopt;
  if (!content.empty() && !is_comment && !stated) return false;
  // A line of tabs or semicolons is a row of empty cells, which is nothing either.
  if (is_comment) comment_ = content.substr(1);
  if (stated) separator_ = *stated;
  rest_.remove_prefix(line.size());
  rest_.remove_prefix(length_of_line_end(rest_));
  ++next_line_;
  return true;
}

/// Reads the cell that begins at `at`, and moves `at` to the separator or line end behind it.
Result<void> TableReader::read_cell(std::size_t& at) {
  const auto is_end = [&](std::size_t k) {
    return k >= rest_.size() || rest_[k] == '\n' || rest_[k] == '\r';
  };
  while (!is_end(at) && is_padding(rest_[at]))
    ++at;
  if (is_end(at) || rest_[at] != '"') {
    const std::size_t begin = at;
    while (!is_end(at) && !is_separator(rest_[at]))
      ++at;
    cells_.push_back(trimmed(rest_.substr(begin, at - begin)));
    return {};
  }
  const std::size_t begin = ++at;
  for (;;) {
    at = rest_.find('"', at);
    if (at == std::string_view::npos)
      return bad("column " + std::to_string(cells_.size() + 1) +
                 ": a quote begins here and never ends; close it");
    if (at + 1 >= rest_.size() || rest_[at + 1] != '"') break;
    at += 2; // two quotes are one that belongs to the text
  }
  const std::string_view content = rest_.substr(begin, at - begin);
  for (std::size_t k = 0; k < content.size(); ++k)
    if (content[k] == '\n' || (content[k] == '\r' && !content.substr(k).starts_with("\r\n")))
      ++next_line_;
  cells_.push_back(trimmed(content));
  ++at;
  const std::size_t closed = at;
  while (!is_end(at) && is_padding(rest_[at]))
    ++at;
  if (is_end(at) || is_separator(rest_[at]) || (at > closed && is_separator(rest_[closed])))
    return {};
  return bad("column " + std::to_string(cells_.size()) +
             ": letters follow the quotes; leave the quotes out, or double those within");
}

Result<bool> TableReader::read_line() {
  while (!rest_.empty() && skip_line()) {
  }
  if (rest_.empty()) return false;
  line_ = next_line_;
  cells_.clear();
  if (separator_ == '\0') separator_ = separator_of(first_line(rest_));
  const auto is_end = [&](std::size_t k) {
    return k >= rest_.size() || rest_[k] == '\n' || rest_[k] == '\r';
  };
  std::size_t at = 0;
  for (;;) {
    if (auto fine = read_cell(at); !fine) return fine.error();
    // A run of blanks separates as one, or belongs to the separator behind it.
    while (!is_end(at) && is_padding(rest_[at]))
      ++at;
    if (is_end(at)) break;
    if (rest_[at] == separator_) ++at;
  }
  rest_.remove_prefix(std::min(at, rest_.size()));
  rest_.remove_prefix(length_of_line_end(rest_));
  ++next_line_;
  return true;
}

Result<void> TableReader::read_head(std::string_view example) {
  if (auto fine = check_is_text(); !fine) return fine;
  const std::string wanted = "; name the columns in the first line, like " + std::string(example);
  const auto any = read_line();
  if (!any) return any.error();
  if (!*any) return Error{Errc::bad_input, name_ + ": is empty" + wanted};
  const auto is_value = [](std::string_view cell) {
    return is_word_for_nothing(cell) || is_number_cell(cell);
  };
  std::vector<std::string_view> named = cells_;
  if (std::all_of(cells_.begin(), cells_.end(), is_value) &&
      std::any_of(cells_.begin(), cells_.end(), is_number_cell)) {
    TableReader comment(comment_, name_);
    const auto read = comment.read_line();
    const bool is_head = read && *read && comment.cells_.size() == cells_.size() &&
                         std::none_of(comment.cells_.begin(), comment.cells_.end(), is_value);
    if (!is_head) return bad("has numbers where the names of the columns should be" + wanted);
    named = comment.cells_;
    is_pending_ = true;
  }
  names_.reserve(named.size());
  for (const std::string_view cell : named)
    names_.push_back(plain(cell));
  while (names_.size() > 1 && names_.back().empty())
    names_.pop_back();
  is_read_.assign(names_.size(), false);
  return {};
}

Result<void> TableReader::begin_without_head(std::size_t columns) {
  if (auto fine = check_is_text(); !fine) return fine;
  names_.assign(columns, "");
  is_read_.assign(columns, true);
  blanks_too_ = true;
  const auto any = read_line();
  if (!any) return any.error();
  const bool are_names =
      cells_.size() == columns && std::none_of(cells_.begin(), cells_.end(), is_number_cell);
  is_pending_ = *any && !are_names;
  return {};
}

std::optional<std::size_t> TableReader::find(std::string_view name) {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  const auto column = static_cast<std::size_t>(found - names_.begin());
  is_read_[column] = true;
  return column;
}

bool TableReader::is_double(std::string_view name) const {
  return std::count(names_.begin(), names_.end(), name) > 1;
}

std::string TableReader::columns_not_read() const {
  constexpr std::size_t max_named = 8;
  std::string text;
  std::size_t count = 0;
  for (std::size_t column = 0; column < names_.size(); ++column) {
    if (is_read_[column] || ++count > max_named) continue;
    text.append(text.empty() ? "" : ", ");
    text += names_[column].empty() ? "column " + std::to_string(column + 1)
                                   : printable(std::string_view(names_[column]).substr(0, 40));
  }
  if (count > max_named) text += " and " + std::to_string(count - max_named) + " more";
  return text;
}

Result<bool> TableReader::next() {
  for (;;) {
    if (!std::exchange(is_pending_, false)) {
      const auto any = read_line();
      if (!any || !*any) return any;
    }
    while (cells_.size() > names_.size() && cells_.back().empty())
      cells_.pop_back();
    const bool is_blank_row =
        std::all_of(cells_.begin(), cells_.end(), [](std::string_view c) { return c.empty(); });
    if (is_blank_row && names_.size() > 1) continue;
    if (cells_.size() == names_.size()) return true;
    return bad("has " + std::to_string(cells_.size()) + (cells_.size() == 1 ? " cell" : " cells") +
               " where there are " + std::to_string(names_.size()) +
               " columns; write one for each, separated as in the first line");
  }
}

bool TableReader::is_missing(std::size_t column) const {
  return is_word_for_nothing(cells_[column]);
}

std::optional<double> TableReader::number(std::size_t column) const {
  return to_finite_number(with_point(cells_[column]));
}

std::optional<std::int64_t> TableReader::scaled(std::size_t column, int digits, double max) const {
  const std::string text = with_point(cells_[column]);
  const auto value = to_finite_number(text);
  if (!value || !(std::abs(*value) <= max)) return std::nullopt;
  if (text.find_first_not_of("+-.0123456789") != std::string::npos)
    return std::llround(*value * std::pow(10.0, digits));
  std::int64_t whole = 0;
  int decimals = -1; // -1: before the point
  bool rounds_up = false;
  for (const char c : text) {
    if (c == '.') decimals = 0;
    if (c < '0' || c > '9') continue;
    if (decimals == digits) rounds_up = c >= '5';
    if (decimals < digits) whole = 10 * whole + (c - '0');
    if (decimals >= 0 && decimals <= digits) ++decimals;
  }
  for (int k = std::max(decimals, 0); k < digits; ++k)
    whole *= 10;
  whole += rounds_up ? 1 : 0;
  return text.front() == '-' ? -whole : whole;
}

} // namespace nendo
