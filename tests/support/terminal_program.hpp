#pragma once
// Runs the nendo program in a terminal of its own, and plays a user who looks at the screen and
// presses keys.

#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <vector>

#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utmp.h>

#include "support/vt_screen.hpp"

namespace nendo::test {

class TerminalProgram {
public:
  /// `term` is the value of TERM for the program.
  TerminalProgram(std::vector<std::string> arguments, unsigned short columns, unsigned short rows,
                  const std::string& term = "xterm", const std::string& program = NENDO_PROGRAM)
      : screen_(columns, rows) {
    arguments.insert(arguments.begin(), program);
    std::vector<std::string> variables{"TERM=" + term};
    for (char** at = environ; *at != nullptr; ++at)
      if (!std::string(*at).starts_with("TERM=")) variables.emplace_back(*at);
    std::vector<char*> environment;
    for (auto& variable : variables)
      environment.push_back(variable.data());
    environment.push_back(nullptr);
    std::vector<char*> argv;
    for (auto& argument : arguments)
      argv.push_back(argument.data());
    argv.push_back(nullptr);
    const winsize size{rows, columns, 0, 0};
    // This end stays open, so that its settings can be read when the program has ended.
    if (::openpty(&master_, &slave_, nullptr, nullptr, &size) != 0) return;
    tcgetattr(slave_, &before_);
    pid_ = ::fork();
    if (pid_ != 0) return;
    ::close(master_);
    ::login_tty(slave_);
    ::execve(argv[0], argv.data(), environment.data());
    ::_exit(127);
  }
  ~TerminalProgram() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(master_);
    ::close(slave_);
  }
  TerminalProgram(const TerminalProgram&) = delete;
  TerminalProgram& operator=(const TerminalProgram&) = delete;

  const VtScreen& screen() const { return screen_; }

  /// Reads until the screen is as wanted. Returns false if that takes too long.
  bool shows(const std::function<bool(const VtScreen&)>& wanted) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!wanted(screen_)) {
      if (std::chrono::steady_clock::now() > end) return false;
      read_some();
    }
    return true;
  }
  bool shows(const std::string& text) {
    return shows([&](const VtScreen& screen) { return screen.shows(text); });
  }
  /// Reads until `text` was printed outside the page. Returns false if that takes too long.
  bool prints(const std::string& text) {
    return shows([&](const VtScreen& screen) {
      return screen.transcript().find(text) != std::string::npos;
    });
  }
  bool press(char key) const { return ::write(master_, &key, 1) == 1; }
  void signal(int number) const { ::kill(pid_, number); }
  void resize(unsigned short columns, unsigned short rows) {
    const winsize size{rows, columns, 0, 0};
    ::ioctl(master_, TIOCSWINSZ, &size);
    drain();
    screen_.resize(columns, rows);
  }

  /// Reads until the program has ended. Returns its exit code; 128 + n if signal n ended it, -1 if
  /// it did not end.
  int wait() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    int status = 0;
    while (::waitpid(pid_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > end) return -1;
      read_some();
    }
    pid_ = 0;
    drain();
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  /// Returns whether the terminal is as it was before the program.
  bool is_restored() const {
    termios after{};
    tcgetattr(slave_, &after);
    return !screen_.on_page() && screen_.cursor_shown() && after.c_lflag == before_.c_lflag &&
           after.c_iflag == before_.c_iflag && after.c_oflag == before_.c_oflag &&
           std::equal(std::begin(after.c_cc), std::end(after.c_cc), std::begin(before_.c_cc));
  }
  /// Returns whether what a line editor changes is as it was before the program.
  bool has_lines_and_echo() const {
    termios now{};
    tcgetattr(slave_, &now);
    return (now.c_lflag & before_.c_lflag & static_cast<tcflag_t>(ICANON | ECHO)) ==
           static_cast<tcflag_t>(ICANON | ECHO);
  }
  bool is_raw() const {
    termios now{};
    tcgetattr(slave_, &now);
    return (now.c_lflag & static_cast<tcflag_t>(ICANON | ECHO)) == 0;
  }

private:
  bool read_some(int patience_ms = 20) {
    pollfd readable{master_, POLLIN, 0};
    if (::poll(&readable, 1, patience_ms) <= 0) return false;
    char bytes[4096];
    const ssize_t got = ::read(master_, bytes, sizeof bytes);
    if (got > 0) screen_.feed(std::string(bytes, static_cast<std::size_t>(got)));
    return got > 0;
  }
  void drain() {
    while (read_some(0)) {
    }
  }

  VtScreen screen_;
  termios before_{};
  int master_ = -1;
  int slave_ = -1;
  pid_t pid_ = 0;
};

} // namespace nendo::test
