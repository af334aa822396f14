#pragma once
// Keys that need no Return, and a terminal that shows a page, which is drawn repeatedly. However
// the command ends, the terminal is then as it was before.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <termios.h>

namespace nendo::cli {

class Keys {
public:
  /// Takes standard input if it is a terminal whose foreground this process is in: no echo, no
  /// Return, no suspending. Ctrl-C stays a signal.
  Keys() noexcept;
  ~Keys(); ///< restore()
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  /// Tells whether keys can come.
  bool are_available() const noexcept { return saved_.has_value(); }
  /// Returns the next key, or nothing if none comes within `timeout` or a signal ends the wait. If
  /// no keys can come, it sleeps for that time.
  std::optional<char> next(std::chrono::milliseconds timeout) noexcept;
  /// Returns true once standard input has ended, as when the window was closed.
  bool have_ended() const noexcept { return gone_; }
  /// Restores the settings of the terminal. Idempotent.
  void restore() noexcept;

private:
  std::optional<termios> saved_; ///< its settings, while it is taken
  bool gone_ = false;
};

struct ScreenSize {
  int columns = 80;
  int rows = 24;
};

/// Returns the present size of the terminal that the file descriptor is, or 80 by 24 if that is
/// unknown.
ScreenSize screen_size(int descriptor) noexcept;

class Terminal {
public:
  /// Takes standard output, which must be a terminal, with its alternate screen and a hidden
  /// cursor. Takes keys, too, if they can come.
  Terminal();
  ~Terminal(); ///< leave()
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Returns the present size of the terminal, or 80 by 24 if that is unknown.
  ScreenSize size() const noexcept;
  /// Replaces the page, in one write. Lines must be printable ASCII; what exceeds the screen is
  /// cut. Blocks while the terminal does not read. An interrupted write stays unfinished.
  void draw(const std::vector<std::string>& lines);
  bool has_keys() const noexcept { return keys_.are_available(); }
  /// Returns the next key. See Keys::next().
  std::optional<char> key(std::chrono::milliseconds timeout) noexcept {
    return keys_.next(timeout);
  }
  /// Returns true once the terminal cannot be written or read any more, as when the window was
  /// closed.
  bool is_gone() const noexcept { return gone_ || keys_.have_ended(); }
  /// Restores the screen and the settings of the terminal. Idempotent.
  void leave() noexcept;

private:
  void write_all(const std::string& text) noexcept;

  Keys keys_;
  ScreenSize drawn_{0, 0}; ///< the size at the last draw()
  bool entered_ = true;
  bool gone_ = false;
};

} // namespace nendo::cli
