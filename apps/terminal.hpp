#pragma once
// A terminal as a page that is drawn again and again, and as keys that need no Return. Whatever
// ends the command, the terminal is as it was before.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <termios.h>

namespace nendo::app {

struct ScreenSize {
  int columns = 80;
  int rows = 24;
};

class Terminal {
public:
  /// Takes standard output, which must be a terminal: the alternate screen, the cursor hidden. If
  /// standard input is a terminal too, keys come without Return and echo; Ctrl-C stays a signal.
  Terminal();
  ~Terminal(); ///< leave()
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// As the terminal tells it now; 80 by 24 if it does not.
  ScreenSize size() const noexcept;
  /// Replaces the page, in one write. Lines are of printable ASCII; what exceeds the screen is cut.
  /// Blocks while the terminal does not read; an interrupted write is left unfinished.
  void draw(const std::vector<std::string>& lines);
  bool has_keys() const noexcept { return saved_.has_value(); }
  /// The next key, waiting for it at most so long; returns early at a signal.
  std::optional<char> key(std::chrono::milliseconds patience) noexcept;
  /// True once the terminal cannot be written or read any more: a closed window.
  bool is_gone() const noexcept { return gone_; }
  /// Gives the terminal back. Idempotent.
  void leave() noexcept;

private:
  void write_all(const std::string& text) noexcept;

  std::optional<termios> saved_; ///< standard input's settings, if it is a terminal
  ScreenSize drawn_{0, 0};       ///< the size at the last draw()
  bool entered_ = true;
  bool gone_ = false;
};

} // namespace nendo::app
