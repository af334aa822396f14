#pragma once
// A terminal as a page that is drawn again and again, and as keys that need no Return. Whatever
// ends the command, the terminal is as it was before.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "cli/keys.hpp"

namespace nendo::cli {

struct ScreenSize {
  int columns = 80;
  int rows = 24;
};

class Terminal {
public:
  /// Takes standard output, which must be a terminal: the alternate screen, the cursor hidden. And
  /// keys, if there can be any.
  Terminal();
  ~Terminal(); ///< leave()
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// As the terminal tells it now; 80 by 24 if it does not.
  ScreenSize size() const noexcept;
  /// Replaces the page, in one write. Lines are of printable ASCII; what exceeds the screen is cut.
  /// Blocks while the terminal does not read; an interrupted write is left unfinished.
  void draw(const std::vector<std::string>& lines);
  bool has_keys() const noexcept { return keys_.are_there(); }
  /// As Keys::next().
  std::optional<char> key(std::chrono::milliseconds patience) noexcept {
    return keys_.next(patience);
  }
  /// True once the terminal cannot be written or read any more: a closed window.
  bool is_gone() const noexcept { return gone_ || keys_.are_gone(); }
  /// Gives the terminal back. Idempotent.
  void leave() noexcept;

private:
  void write_all(const std::string& text) noexcept;

  Keys keys_;
  ScreenSize drawn_{0, 0}; ///< the size at the last draw()
  bool entered_ = true;
  bool gone_ = false;
};

} // namespace nendo::cli
