#include "cli/terminal.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <thread>
#include <utility>

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/cli.hpp"

namespace nendo::cli {
namespace {

// ECMA-48 and xterm's private modes (xterm control sequences: 1049 alternate screen, 25 cursor).
const std::string enter_sequence = "\x1b[?1049h\x1b[?25l\x1b[2J";
const std::string leave_sequence = "\x1b[?25h\x1b[?1049l";
const std::string clear_page = "\x1b[2J";
const std::string clear_below = "\x1b[J";

std::string move_to_row(int row) {
  std::string sequence = "\x1b[";
  return sequence.append(std::to_string(row)).append(";1H");
}

} // namespace

bool has_control_codes(int descriptor) noexcept {
  const char* const name = std::getenv("TERM");
  const std::string_view term = name != nullptr ? name : "";
  return ::isatty(descriptor) != 0 && !term.empty() && term != "dumb";
}

Keys::Keys(Page* page) noexcept : page_(page) {
  take();
}

void Keys::take() noexcept {
  termios settings{};
  if (tcgetattr(STDIN_FILENO, &settings) != 0) return;
  const pid_t foreground = tcgetpgrp(STDIN_FILENO); // -1: a terminal without a session
  if (foreground >= 0 && foreground != getpgrp())
    return; // the system would stop a process in the background
  saved_ = settings;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  settings.c_iflag &= ~static_cast<tcflag_t>(IXON); // a stopped terminal could not be restored
  settings.c_cc[VSUSP] = _POSIX_VDISABLE;           // suspend() restores the terminal before
  settings.c_cc[VQUIT] = _POSIX_VDISABLE;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSADRAIN, &settings);
  if (!std::exchange(suspended_, false) || page_ == nullptr) return;
  page_->show();
}

/// The signal goes to the whole job, as from the terminal. A process without a shell that could
/// continue it is not stopped by it.
void Keys::suspend() noexcept {
  if (page_ != nullptr) page_->hide();
  restore();
  suspended_ = true;
  ::kill(0, SIGTSTP);
  take();
}

Keys::~Keys() {
  restore();
}

void Keys::restore() noexcept {
  if (saved_) tcsetattr(STDIN_FILENO, TCSADRAIN, &*saved_);
  saved_.reset();
}

std::optional<char> Keys::next(std::chrono::milliseconds timeout) noexcept {
  if (suspended_) take();
  if (!saved_ || gone_) {
    std::this_thread::sleep_for(timeout);
    return std::nullopt;
  }
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (::poll(&input, 1, static_cast<int>(timeout.count())) <= 0) return std::nullopt;
  char pressed = 0;
  const ssize_t got = ::read(STDIN_FILENO, &pressed, 1);
  if (got == 1) {
    const cc_t suspending = saved_->c_cc[VSUSP];
    if (suspending == _POSIX_VDISABLE || pressed != static_cast<char>(suspending)) return pressed;
    suspend();
    return std::nullopt;
  }
  if (got == 0 || errno != EINTR) gone_ = true;
  return std::nullopt;
}

Terminal::Terminal() : keys_(this), plain_(!has_control_codes(STDOUT_FILENO)) {
  if (!plain_) write_all(enter_sequence);
}

Terminal::~Terminal() {
  leave();
}

void Terminal::leave() noexcept {
  if (!entered_) return;
  entered_ = false;
  if (!plain_ && !hidden_) write_all(leave_sequence);
  keys_.restore();
}

void Terminal::hide() noexcept {
  hidden_ = true;
  if (!plain_) write_all(leave_sequence);
}

void Terminal::show() noexcept {
  hidden_ = false;
  drawn_ = {0, 0};
  if (!plain_) write_all(enter_sequence);
}

ScreenSize Terminal::size() const noexcept {
  return screen_size(STDOUT_FILENO);
}

ScreenSize screen_size(int descriptor) noexcept {
  constexpr int max = 500; // limits the memory of a line
  winsize window{};
  if (ioctl(descriptor, TIOCGWINSZ, &window) != 0 || window.ws_col == 0 || window.ws_row == 0)
    return {};
  return {std::min<int>(window.ws_col, max), std::min<int>(window.ws_row, max)};
}

void Terminal::draw(const std::vector<std::string>& lines) {
  if (hidden_) return;
  if (plain_) return print_changed(lines);
  const ScreenSize now = size();
  const auto columns = static_cast<std::size_t>(now.columns);
  const int rows = std::min(now.rows, static_cast<int>(lines.size()));
  std::string page;
  if (now.columns != drawn_.columns || now.rows != drawn_.rows) page = clear_page;
  drawn_ = now;
  // Lines are filled with blanks rather than cleared: nothing ever flickers, and a line that ends
  // in the last column keeps its last character.
  for (int row = 0; row < rows; ++row) {
    std::string line = lines[static_cast<std::size_t>(row)];
    line.resize(columns, ' ');
    page += move_to_row(row + 1) + line;
  }
  if (rows < now.rows) page += move_to_row(rows + 1) + clear_below;
  write_all(page);
}

void Terminal::print_changed(const std::vector<std::string>& lines) {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_print_) return;
  next_print_ = now + std::chrono::seconds(1);
  std::string text;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (k < printed_.size() && printed_[k] == lines[k]) continue;
    text += lines[k] + "\n";
  }
  printed_ = lines;
  write_all(text);
}

void Terminal::write_all(const std::string& text) noexcept {
  for (std::size_t at = 0; at < text.size() && !gone_;) {
    const ssize_t written = ::write(STDOUT_FILENO, text.data() + at, text.size() - at);
    if (written >= 0) {
      at += static_cast<std::size_t>(written);
    } else if (errno == EAGAIN) {
      pollfd output{STDOUT_FILENO, POLLOUT, 0};
      if (::poll(&output, 1, 100) < 0 && stop_requested()) return;
    } else if (errno != EINTR) {
      gone_ = true;
    } else if (stop_requested() && entered_) {
      return;
    }
  }
}

} // namespace nendo::cli
