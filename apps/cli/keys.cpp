#include "cli/keys.hpp"

#include <cerrno>
#include <thread>

#include <poll.h>
#include <unistd.h>

namespace nendo::cli {

Keys::Keys() noexcept {
  termios settings{};
  if (tcgetattr(STDIN_FILENO, &settings) != 0) return;
  const pid_t foreground = tcgetpgrp(STDIN_FILENO);       // -1: a terminal that controls nobody
  if (foreground >= 0 && foreground != getpgrp()) return; // one would be stopped for it
  saved_ = settings;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  settings.c_iflag &= ~static_cast<tcflag_t>(IXON); // a stopped terminal could not be given back
  settings.c_cc[VSUSP] = _POSIX_VDISABLE;           // nor one whose program is suspended
  settings.c_cc[VQUIT] = _POSIX_VDISABLE;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSADRAIN, &settings);
}

Keys::~Keys() {
  give_back();
}

void Keys::give_back() noexcept {
  if (saved_) tcsetattr(STDIN_FILENO, TCSADRAIN, &*saved_);
  saved_.reset();
}

std::optional<char> Keys::next(std::chrono::milliseconds patience) noexcept {
  if (!saved_ || gone_) {
    std::this_thread::sleep_for(patience);
    return std::nullopt;
  }
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (::poll(&input, 1, static_cast<int>(patience.count())) <= 0) return std::nullopt;
  char pressed = 0;
  const ssize_t got = ::read(STDIN_FILENO, &pressed, 1);
  if (got == 1) return pressed;
  if (got == 0 || errno != EINTR) gone_ = true;
  return std::nullopt;
}

} // namespace nendo::cli
