#pragma once
// A screen that exists in memory alone.

#include <csignal>
#include <cstdlib>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace nendo::test {

/// An Xvfb of this test's own; its number is in DISPLAY while it lives. It continues when its last
/// client leaves: without -noreset it would restart then, and refuse who comes meanwhile.
class MemoryScreen {
public:
  MemoryScreen() {
    int ends[2];
    if (::pipe(ends) != 0) return;
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(ends[1], 3);
      ::execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "800x600x24", "-nolisten", "tcp",
               "-noreset", nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    std::string number;
    for (char digit = 0; ::read(ends[0], &digit, 1) == 1 && digit != '\n';)
      number += digit;
    ::close(ends[0]);
    is_there_ = !number.empty();
    if (is_there_) ::setenv("DISPLAY", (":" + number).c_str(), 1);
  }
  ~MemoryScreen() {
    ::unsetenv("DISPLAY");
    if (pid_ <= 0) return;
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  bool is_there() const noexcept { return is_there_; }

private:
  pid_t pid_ = 0;
  bool is_there_ = false;
};

} // namespace nendo::test
