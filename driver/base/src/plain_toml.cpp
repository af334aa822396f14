#include <nendo/base/plain_toml.hpp>

#include <algorithm>
#include <utility>

#include <nendo/base/text.hpp>

namespace nendo {
namespace {

constexpr std::string_view word_letters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";

bool skip_digits(std::string_view& word) noexcept {
  const std::size_t count = std::min(word.find_first_not_of("0123456789"), word.size());
  word.remove_prefix(count);
  return count > 0;
}
bool skip_one_of(std::string_view& word, std::string_view letters) noexcept {
  if (word.empty() || letters.find(word.front()) == std::string_view::npos) return false;
  word.remove_prefix(1);
  return true;
}
/// Skips what has a digit wherever the pattern has 0, and its other characters.
bool skip_like(std::string_view& word, std::string_view pattern) noexcept {
  if (word.size() < pattern.size()) return false;
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    const bool is_digit = word[at] >= '0' && word[at] <= '9';
    if (pattern[at] == '0' ? !is_digit : word[at] != pattern[at]) return false;
  }
  word.remove_prefix(pattern.size());
  return true;
}

/// A decimal number, inf or nan.
bool is_number(std::string_view word) noexcept {
  skip_one_of(word, "+-");
  if (word == "inf" || word == "nan") return true;
  if (!skip_digits(word)) return false;
  if (skip_one_of(word, ".") && !skip_digits(word)) return false;
  if (!skip_one_of(word, "eE")) return word.empty();
  skip_one_of(word, "+-");
  return skip_digits(word) && word.empty();
}
/// Date and time; a fraction of a second and a zone may follow.
bool is_time(std::string_view word) noexcept {
  if (!skip_like(word, "0000-00-00T00:00:00")) return false;
  if (skip_one_of(word, ".") && !skip_digits(word)) return false;
  return word.empty() || word == "Z" ||
         ((skip_like(word, "+00:00") || skip_like(word, "-00:00")) && word.empty());
}

/// Goes over the text once. Each function that reads returns false at the first fault.
class TomlScanner {
public:
  explicit TomlScanner(std::string_view text) noexcept : rest_(without_mark(text)) {}

  std::optional<TomlFault> run() {
    while (!fault_ && !rest_.empty())
      if (line()) end_of_line();
    return std::move(fault_);
  }

private:
  char next() const noexcept { return rest_.empty() ? '\0' : rest_.front(); }
  bool skip(char wanted) noexcept {
    if (rest_.empty() || rest_.front() != wanted) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void skip_blanks() noexcept {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size()));
  }
  bool complain(std::string what) {
    if (!fault_) fault_ = TomlFault{line_, std::move(what)};
    return false;
  }
  bool expect(char wanted, std::string_view where) {
    if (skip(wanted)) return true;
    return complain(std::string("expected ") + wanted + " " + std::string(where) +
                    ", and there is " + seen());
  }
  std::string seen() const {
    if (rest_.empty()) return "the end of the file";
    if (next() == '\n' || next() == '\r') return "the end of the line";
    return in_quotes(rest_.substr(0, 1));
  }

  /// The part of a line before its comment.
  bool line() {
    skip_blanks();
    if (rest_.empty() || next() == '#' || next() == '\n' || next() == '\r') return true;
    if (skip('[')) return header();
    return pair(0);
  }
  bool end_of_line() {
    skip_blanks();
    if (!comment()) return false;
    if (rest_.empty() || line_break()) return true;
    return complain("expected the end of the line, and there is " + seen());
  }
  bool line_break() noexcept {
    if (rest_.starts_with("\r\n")) rest_.remove_prefix(1);
    if (!skip('\n')) return false;
    ++line_;
    return true;
  }
  bool comment() { return !skip('#') || text_until("\n"); }
  /// Skips to the first of these characters, or to the end. Tabs are the only control characters.
  bool text_until(std::string_view ends) {
    const std::string_view text = rest_.substr(0, rest_.find_first_of(ends));
    const bool crlf = text.ends_with('\r') && text.size() < rest_.size();
    const std::string_view body = text.substr(0, text.size() - (crlf ? 1 : 0));
    if (!is_utf8(body)) return complain("the text is not UTF-8; save the file as UTF-8");
    for (const char letter : body)
      if ((static_cast<unsigned char>(letter) < 0x20 && letter != '\t') || letter == '\x7F')
        return complain("there is a control character; delete it");
    rest_.remove_prefix(body.size());
    return true;
  }

  bool header() {
    const bool is_list = skip('[');
    skip_blanks();
    if (!key()) return false;
    return expect(']', "after the table's name") && (!is_list || expect(']', "after ]"));
  }
  bool pair(int depth) {
    if (!key() || !expect('=', "after a key")) return false;
    skip_blanks();
    return value(depth);
  }
  bool key() {
    for (int parts = 1; parts <= max_toml_depth; ++parts) {
      if (!key_part()) return false;
      skip_blanks();
      if (!skip('.')) return true;
      skip_blanks();
    }
    return complain("a key has more than " + std::to_string(max_toml_depth) +
                    " parts; this program knows none of so many");
  }
  bool key_part() {
    if (next() == '"' || next() == '\'') return quoted();
    const std::size_t size = std::min(rest_.find_first_not_of(word_letters), rest_.size());
    if (size == 0) return complain("expected a key, and there is " + seen());
    rest_.remove_prefix(size);
    return true;
  }
  bool quoted() {
    const char quote = next();
    if (rest_.starts_with("\"\"\"") || rest_.starts_with("'''"))
      return complain(
          "a text has three quotes; write it on one line, in one pair of quotes, or as a "
          "value between three single ones");
    rest_.remove_prefix(1);
    while (text_until(quote == '"' ? "\"\\\n" : "'\n")) {
      if (skip(quote)) return true;
      if (!skip('\\')) return complain("a text has no closing quote on its line; add it");
      if (next() == '"' || next() == '\\') rest_.remove_prefix(1);
    }
    return false;
  }
  /// A text over several lines, between three single quotes.
  bool long_text() {
    rest_.remove_prefix(3);
    while (text_until("\n'")) {
      if (rest_.starts_with("''''"))
        return complain("a text ends with four quotes; it needs three");
      if (rest_.starts_with("'''")) {
        rest_.remove_prefix(3);
        return true;
      }
      if (!skip('\'') && !line_break())
        return complain("a text in three quotes has no end; add '''");
    }
    return false;
  }
  bool value(int depth) {
    if (rest_.starts_with("'''")) return long_text();
    if (next() == '"' || next() == '\'') return quoted();
    if (next() != '[' && next() != '{') return word();
    if (depth == max_toml_depth)
      return complain("lists and tables are nested more than " + std::to_string(max_toml_depth) +
                      " deep within each other; this program knows none so deep");
    return skip('[') ? list(depth + 1) : skip('{') && table(depth + 1);
  }
  bool word() {
    const auto is_part = [](char letter) {
      return letter == '+' || letter == '.' || letter == ':' ||
             word_letters.find(letter) != std::string_view::npos;
    };
    const auto size = static_cast<std::size_t>(
        std::find_if_not(rest_.begin(), rest_.end(), is_part) - rest_.begin());
    const std::string_view word = rest_.substr(0, size);
    if (word.empty()) return complain("expected a value, and there is " + seen());
    if (word != "true" && word != "false" && !is_number(word) && !is_time(word))
      return complain(in_quotes(word) + " is no value; a text needs quotes, a number is written as "
                                        "-1.5e3, a time as 2026-11-21T19:27:05Z");
    rest_.remove_prefix(size);
    return true;
  }
  /// Skips blanks, line breaks and comments between the values of a list.
  bool gap() {
    do {
      skip_blanks();
      if (!comment()) return false;
    } while (line_break());
    return true;
  }
  bool list(int depth) {
    while (gap()) {
      if (skip(']')) return true;
      if (!value(depth) || !gap()) return false;
      if (skip(']')) return true;
      if (!expect(',', "or ] in a list")) return false;
    }
    return false;
  }
  bool table(int depth) {
    skip_blanks();
    if (skip('}')) return true;
    for (;;) {
      skip_blanks();
      if (!pair(depth)) return false;
      skip_blanks();
      if (skip('}')) return true;
      if (!expect(',', "or } in a table")) return false;
    }
  }

  std::string_view rest_;
  std::size_t line_ = 1;
  std::optional<TomlFault> fault_;
};

} // namespace

std::optional<TomlFault> find_toml_fault(std::string_view text) {
  return TomlScanner(text).run();
}

} // namespace nendo
