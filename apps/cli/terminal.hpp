#pragma once
// Keys that need no Return, and a terminal that shows a page, which is drawn repeatedly. However
// the command ends, and while it is suspended (Ctrl-Z), the terminal is as it was before.

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
  /// What is shown while keys can come.
  class Page {
  public:
    virtual void hide() noexcept = 0; ///< called before the program is suspended
    virtual void show() noexcept = 0; ///< called when it is in the foreground again
  protected:
    ~Page() = default;
  };

  /// Takes standard input if it is a terminal whose foreground this process is in: no echo, no
  /// Return. Ctrl-C stays a signal. next() handles Ctrl-Z. `page`, if any, must outlive this.
  explicit Keys(Page* page = nullptr) noexcept;
  ~Keys(); ///< restore()
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  /// Returns whether keys can come.
  bool are_available() const noexcept { return saved_.has_value(); }
  /// Returns the next key, or nothing if none comes within `timeout` or a signal ends the wait. If
  /// no keys can come, it sleeps for that time. Ctrl-Z suspends the program and all of its job, as
  /// the terminal would: this returns when the job continues. If it continues in the background,
  /// the terminal is left alone until it is in the foreground.
  std::optional<char> next(std::chrono::milliseconds timeout) noexcept;
  /// Returns true once standard input has ended, as when the window was closed.
  bool have_ended() const noexcept { return gone_; }
  /// Restores the settings of the terminal. Idempotent.
  void restore() noexcept;

private:
  void take() noexcept;
  void suspend() noexcept;

  Page* const page_;
  std::optional<termios> saved_; ///< its settings, while it is taken
  bool suspended_ = false;       ///< it was taken, and is to be taken again in the foreground
  bool gone_ = false;
};

struct ScreenSize {
  int columns = 80;
  int rows = 24;
};

/// Returns the present size of the terminal that the file descriptor is, or 80 by 24 if that is
/// unknown.
ScreenSize screen_size(int descriptor) noexcept;

class Terminal final : private Keys::Page {
public:
  /// Takes standard output, which must be a terminal, with its alternate screen and a hidden
  /// cursor. Takes keys, if they can come. It gets control codes only if it has them.
  Terminal();
  ~Terminal(); ///< leave()
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Returns the present size of the terminal, or 80 by 24 if that is unknown.
  ScreenSize size() const noexcept;
  /// Returns true if the terminal has no control codes.
  bool is_plain() const noexcept { return plain_; }
  /// Replaces the page, in one write. Lines must be printable ASCII; what exceeds the screen is
  /// cut. Blocks while the terminal does not read. An interrupted write stays unfinished. On a
  /// plain terminal, prints the lines that have changed, at most once a second.
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
  void hide() noexcept override;
  void show() noexcept override;
  void print_changed(const std::vector<std::string>& lines);
  void write_all(const std::string& text) noexcept;

  Keys keys_;
  const bool plain_;
  ScreenSize drawn_{0, 0}; ///< the size at the last draw()
  bool entered_ = true;
  bool hidden_ = false; ///< the program is suspended, or was and is in the background
  bool gone_ = false;
  std::vector<std::string> printed_; ///< on a plain terminal, the last lines
  std::chrono::steady_clock::time_point next_print_{};
};

} // namespace nendo::cli
