#include "cli/terminal.hpp"

#include <algorithm>
#include <cerrno>
#include <thread>

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

Keys::Keys() noexcept {
  termios settings{};
  if (tcgetattr(STDIN_FILENO, &settings) != 0) return;
  const pid_t foreground = tcgetpgrp(STDIN_FILENO); // -1: a terminal that controls nobody
  if (foreground >= 0 && foreground != getpgrp())
    return; // the system would stop a process in the background
  saved_ = settings;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  settings.c_iflag &= ~static_cast<tcflag_t>(IXON); // a stopped terminal could not be restored
  settings.c_cc[VSUSP] = _POSIX_VDISABLE;           // nor that of a suspended program
  settings.c_cc[VQUIT] = _POSIX_VDISABLE;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSADRAIN, &settings);
}

Keys::~Keys() {
  restore();
}

void Keys::restore() noexcept {
  if (saved_) tcsetattr(STDIN_FILENO, TCSADRAIN, &*saved_);
  saved_.reset();
}

std::optional<char> Keys::next(std::chrono::milliseconds timeout) noexcept {
  if (!saved_ || gone_) {
    std::this_thread::sleep_for(timeout);
    return std::nullopt;
  }
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (::poll(&input, 1, static_cast<int>(timeout.count())) <= 0) return std::nullopt;
  char pressed = 0;
  const ssize_t got = ::read(STDIN_FILENO, &pressed, 1);
  if (got == 1) return pressed;
  if (got == 0 || errno != EINTR) gone_ = true;
  return std::nullopt;
}

Terminal::Terminal() {
  write_all(enter_sequence);
}

Terminal::~Terminal() {
  leave();
}

void Terminal::leave() noexcept {
  if (!entered_) return;
  entered_ = false;
  write_all(leave_sequence);
  keys_.restore();
}

ScreenSize Terminal::size() const noexcept {
  return screen_size(STDOUT_FILENO);
}

ScreenSize screen_size(int descriptor) noexcept {
  constexpr int most = 500; // nobody's screen, and a bound for what a line may take
  winsize window{};
  if (ioctl(descriptor, TIOCGWINSZ, &window) != 0 || window.ws_col == 0 || window.ws_row == 0)
    return {};
  return {std::min<int>(window.ws_col, most), std::min<int>(window.ws_row, most)};
}

void Terminal::draw(const std::vector<std::string>& lines) {
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
