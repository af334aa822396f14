#pragma once
// The screen of a terminal (ECMA-48, xterm) with the few functions that the program may use.
// Unknown sequences, and text that leaves the screen, are kept as faults.

#include <string>
#include <vector>

namespace nendo::test {

class VtScreen {
public:
  VtScreen(int columns, int rows) { resize(columns, rows); }

  void resize(int columns, int rows) {
    columns_ = columns;
    lines_.assign(static_cast<std::size_t>(rows),
                  std::string(static_cast<std::size_t>(columns), ' '));
    row_ = column_ = 0;
  }

  void feed(const std::string& bytes) {
    for (const char c : bytes) {
      if (!sequence_.empty()) {
        sequence_ += c;
        if (sequence_.size() > 2 && c >= '@' && c <= '~') {
          handle(sequence_.substr(2, sequence_.size() - 3), c);
          sequence_.clear();
        } else if (sequence_.size() == 2 && c != '[') {
          fault("escape " + sequence_.substr(1));
          sequence_.clear();
        }
      } else if (c == '\x1b') {
        sequence_ = c;
      } else {
        put(c);
      }
    }
  }

  /// Returns the rows of the page, which are as long as the screen is wide.
  const std::vector<std::string>& lines() const { return lines_; }
  /// Returns the row that begins with `name`; an empty text if there is none.
  std::string line_of(const std::string& name) const {
    for (const auto& line : lines_) {
      if (line.starts_with(name)) return line;
    }
    return {};
  }
  bool shows(const std::string& text) const {
    for (const auto& line : lines_) {
      if (line.find(text) != std::string::npos) return true;
    }
    return false;
  }
  /// Returns what was printed outside the page.
  const std::string& transcript() const { return transcript_; }
  bool on_page() const { return on_page_; } ///< the alternate screen
  bool cursor_shown() const { return cursor_shown_; }
  int pages() const { return pages_; } ///< times that drawing began at the top
  const std::string& faults() const { return faults_; }
  int sequences() const { return sequences_; } ///< control sequences so far

private:
  void fault(const std::string& what) { faults_ += what + "; "; }

  void put(char c) {
    if (!on_page_) {
      if (c != '\r') transcript_ += c;
      return;
    }
    if (c < ' ' || c > '~') {
      fault("control character " + std::to_string(int{c}));
    } else if (row_ >= static_cast<int>(lines_.size()) || column_ >= columns_) {
      fault("text outside the screen");
    } else {
      lines_[static_cast<std::size_t>(row_)][static_cast<std::size_t>(column_++)] = c;
    }
  }

  void handle(const std::string& parameters, char final) {
    ++sequences_;
    if (parameters == "?1049" && (final == 'h' || final == 'l')) {
      on_page_ = final == 'h';
    } else if (parameters == "?25" && (final == 'h' || final == 'l')) {
      cursor_shown_ = final == 'h';
    } else if (parameters.ends_with(";1") && final == 'H') {
      row_ = std::stoi(parameters) - 1;
      column_ = 0;
      if (row_ == 0) ++pages_;
      if (row_ >= static_cast<int>(lines_.size())) fault("cursor outside the screen");
    } else if (final == 'J' && (parameters.empty() || parameters == "2")) {
      const int first = parameters.empty() ? row_ : 0;
      // A program clears the screen after a new size, so what was on its way is no fault.
      if (!parameters.empty()) faults_.clear();
      for (auto row = static_cast<std::size_t>(first); row < lines_.size(); ++row)
        lines_[row].assign(static_cast<std::size_t>(columns_), ' ');
    } else {
      fault("sequence " + parameters + final);
    }
  }

  int columns_ = 0;
  int row_ = 0;
  int column_ = 0;
  std::vector<std::string> lines_;
  std::string sequence_;
  std::string transcript_;
  std::string faults_;
  bool on_page_ = false;
  bool cursor_shown_ = true;
  int pages_ = 0;
  int sequences_ = 0;
};

} // namespace nendo::test
