#pragma once
// Unbuffered keys, and a terminal that repeatedly draws a page. The terminal is restored at any end
// of the command, and while it is suspended (Ctrl-Z).

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <termios.h>

namespace nendo::cli {

/// Returns whether the file descriptor is a terminal with control codes: TERM is neither empty nor
/// "dumb".
bool has_control_codes(int descriptor) noexcept;

class Keys {
public:
  /// The page that is visible while keys are read.
  class Page {
  public:
    virtual void hide() noexcept = 0; ///< called before the program is suspended
    virtual void show() noexcept = 0; ///< called when it is in the foreground again
  protected:
    ~Page() = default;
  };

  /// If standard input is a terminal with this process in the foreground, turns off echo and line
  /// buffering. Ctrl-C stays a signal. next() handles Ctrl-Z. `page`, if any, must outlive this.
  explicit Keys(Page* page = nullptr) noexcept;
  ~Keys(); ///< restore()
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  /// Returns whether keys can be read.
  bool are_available() const noexcept { return saved_.has_value(); }
  /// Returns the next key, or nothing at `timeout` or at a signal. If no keys can be read, sleeps
  /// for `timeout`. Ctrl-Z suspends the process group, as the terminal would; then this returns
  /// when the job continues. If it continues in the background, the terminal is not changed until
  /// it is in the foreground.
  std::optional<char> next(std::chrono::milliseconds timeout) noexcept;
  /// Returns whether standard input has ended, as after closing the window.
  bool have_ended() const noexcept { return gone_; }
  /// Restores the settings of the terminal. Idempotent.
  void restore() noexcept;

private:
  void take() noexcept;
  void suspend() noexcept;

  Page* const page_;
  std::optional<termios> saved_; ///< the original settings, while they are changed
  bool suspended_ = false;       ///< change the settings again in the foreground
  bool gone_ = false;
};

struct ScreenSize {
  int columns = 80;
  int rows = 24;
};

/// Returns the current size of the file descriptor's terminal, or 80 by 24 if that is unknown.
ScreenSize screen_size(int descriptor) noexcept;

class Terminal final : private Keys::Page {
public:
  /// Switches standard output, which must be a terminal, to the alternate screen, and hides the
  /// cursor, if it has control codes. Reads keys, if possible.
  Terminal();
  ~Terminal(); ///< leave()
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Returns the current size of the terminal, or 80 by 24 if that is unknown.
  ScreenSize size() const noexcept;
  /// Returns true if the terminal has no control codes.
  bool is_plain() const noexcept { return plain_; }
  /// Replaces the page, in one write. Lines must be printable ASCII, and are clipped to the screen.
  /// Blocks while the terminal does not read. Does not resume an interrupted write. On a plain
  /// terminal, prints the changed lines, at most once per second.
  void draw(const std::vector<std::string>& lines);
  bool has_keys() const noexcept { return keys_.are_available(); }
  /// Returns the next key. See Keys::next().
  std::optional<char> key(std::chrono::milliseconds timeout) noexcept {
    return keys_.next(timeout);
  }
  /// Returns whether the terminal can no longer be written or read, as after closing the window.
  bool is_gone() const noexcept { return gone_ || keys_.have_ended(); }
  /// Restores the screen and the settings of the terminal. Idempotent.
  void leave() noexcept;

private:
  void hide() noexcept override;
  void show() noexcept override;
  void print_changed(const std::vector<std::string>& lines);
  void write_all(const std::string& text) noexcept;

  Keys keys_;
  const bool plain_;
  ScreenSize drawn_{0, 0}; ///< the size at the last draw()
  bool entered_ = true;
  bool hidden_ = false; ///< the program is suspended, or continued in the background
  bool gone_ = false;
  std::vector<std::string> printed_; ///< the last lines on a plain terminal
  std::chrono::steady_clock::time_point next_print_{};
};

} // namespace nendo::cli
