#include "files/text_scanner.hpp"

namespace nendo::deform {
namespace {

constexpr bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

} // namespace

/// The length of the line end at this place; 0 if there is none.
std::size_t TextScanner::line_end_length(std::size_t at) const noexcept {
  if (at >= text_.size()) return 0;
  if (text_[at] == '\n') return 1;
  if (text_[at] != '\r') return 0;
  return at + 1 < text_.size() && text_[at + 1] == '\n' ? 2 : 1;
}

/// The length of a backslash, and of the blanks and the line end after it; 0 if there is none at
/// this place.
std::size_t TextScanner::continuation_length() const noexcept {
  if (dialect_ != Dialect::obj || text_[at_] != '\\') return 0;
  std::size_t at = at_ + 1;
  while (at < text_.size() && is_blank(text_[at]))
    ++at;
  const std::size_t ending = line_end_length(at);
  return ending > 0 ? at - at_ + ending : 0;
}

std::string_view TextScanner::field() noexcept {
  while (at_ < text_.size()) {
    if (const std::size_t length = continuation_length(); length > 0) {
      at_ += length;
      ++line_;
    } else if (is_blank(text_[at_])) {
      ++at_;
    } else {
      break;
    }
  }
  if (at_ == text_.size() || line_end_length(at_) > 0) return {};
  if (dialect_ == Dialect::obj && text_[at_] == '#') return {};
  const std::size_t begin = at_;
  while (at_ < text_.size() && line_end_length(at_) == 0 && !is_blank(text_[at_]) &&
         continuation_length() == 0)
    ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view TextScanner::field_on_any_line() noexcept {
  for (;;) {
    const std::string_view found = field();
    if (!found.empty() || !next_line()) return found;
  }
}

std::string_view TextScanner::rest_of_line() const noexcept {
  const std::size_t end = text_.find_first_of("\r\n", at_);
  return text_.substr(at_, end == std::string_view::npos ? end : end - at_);
}

std::string joined_fields(TextScanner& scanner) {
  std::string joined;
  for (auto field = scanner.field(); !field.empty(); field = scanner.field()) {
    if (!joined.empty()) joined += ' ';
    joined += field;
  }
  return joined;
}

bool TextScanner::next_line() noexcept {
  // A continued line ends where its last part ends; a comment is never continued.
  bool comment = false;
  while (at_ < text_.size() && line_end_length(at_) == 0) {
    comment = comment || text_[at_] == '#';
    const std::size_t continued = comment ? 0 : continuation_length();
    line_ += continued > 0 ? 1 : 0;
    at_ += continued > 0 ? continued : 1;
  }
  if (at_ == text_.size()) return false;
  at_ += line_end_length(at_);
  ++line_;
  return true;
}

} // namespace nendo::deform
