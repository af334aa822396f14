#pragma once
// Reads keys that need no Return, if standard input is a terminal. However the command ends, the
// terminal is then as it was before.

#include <chrono>
#include <optional>

#include <termios.h>

namespace nendo::cli {

class Keys {
public:
  /// Takes standard input if it is a terminal whose foreground this process is in: no echo, no
  /// Return, no suspending. Ctrl-C stays a signal.
  Keys() noexcept;
  ~Keys(); ///< give_back()
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  /// Tells whether keys can come.
  bool are_there() const noexcept { return saved_.has_value(); }
  /// Returns the next key, and waits for it at most so long. If no keys can come, it sleeps for
  /// that time. A signal ends the wait.
  std::optional<char> next(std::chrono::milliseconds patience) noexcept;
  /// Returns true once standard input has ended, as when the window was closed.
  bool are_gone() const noexcept { return gone_; }
  /// Gives the terminal back. Idempotent.
  void give_back() noexcept;

private:
  std::optional<termios> saved_; ///< its settings, while it is taken
  bool gone_ = false;
};

} // namespace nendo::cli
