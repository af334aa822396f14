#pragma once
// Keys that need no Return, while standard input is a terminal. Whatever ends the command, the
// terminal is as it was before.

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

  /// Whether any can come.
  bool are_there() const noexcept { return saved_.has_value(); }
  /// The next key, waiting for it at most so long, which is slept through where none can come;
  /// returns early at a signal.
  std::optional<char> next(std::chrono::milliseconds patience) noexcept;
  /// True once standard input has ended: a closed window.
  bool are_gone() const noexcept { return gone_; }
  /// Idempotent.
  void give_back() noexcept;

private:
  std::optional<termios> saved_; ///< its settings, while it is taken
  bool gone_ = false;
};

} // namespace nendo::cli
