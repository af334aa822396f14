#pragma once
// A terminal that shows a page, which is drawn repeatedly, and reads keys that need no Return.
// However the command ends, the terminal is then as it was before.

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
  /// Takes standard output, which must be a terminal, with its alternate screen and a hidden
  /// cursor. Takes keys, too, if they can come.
  Terminal();
  ~Terminal(); ///< leave()
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Returns the size that the terminal tells now, or 80 by 24 if it tells none.
  ScreenSize size() const noexcept;
  /// Replaces the page, in one write. Lines must be printable ASCII; what exceeds the screen is
  /// cut. Blocks while the terminal does not read. An interrupted write stays unfinished.
  void draw(const std::vector<std::string>& lines);
  bool has_keys() const noexcept { return keys_.are_there(); }
  /// Returns the next key. See Keys::next().
  std::optional<char> key(std::chrono::milliseconds patience) noexcept {
    return keys_.next(patience);
  }
  /// Returns true once the terminal cannot be written or read any more, as when the window was
  /// closed.
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
