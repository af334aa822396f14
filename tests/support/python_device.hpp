#pragma once
// A device that a Python program emulates on a pseudo-terminal: an independent reference for a
// driver. Its first line of output is the terminal's path. It answers each line of input with one.

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace nendo::test {

class PythonDevice {
public:
  explicit PythonDevice(const std::string& script, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"python3", "-B", script});
    std::vector<char*> argv;
    for (std::string& option : options)
      argv.push_back(option.data());
    argv.push_back(nullptr);
    std::array<int, 2> input{};
    std::array<int, 2> output{};
    if (::pipe2(input.data(), O_CLOEXEC) != 0 || ::pipe2(output.data(), O_CLOEXEC) != 0)
      throw std::runtime_error("no pipe");
    ::signal(SIGPIPE, SIG_IGN); // if the program ends early, answers are empty
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(input[0], STDIN_FILENO);
      ::dup2(output[1], STDOUT_FILENO);
      ::execvp(argv[0], argv.data());
      ::_exit(127);
    }
    ::close(input[0]);
    ::close(output[1]);
    input_ = ::fdopen(input[1], "w");
    output_ = ::fdopen(output[0], "r");
    path_ = line();
    if (path_.empty()) throw std::runtime_error("python3 does not run " + script);
  }
  ~PythonDevice() { unplug(); }
  PythonDevice(const PythonDevice&) = delete;
  PythonDevice& operator=(const PythonDevice&) = delete;

  const std::string& path() const { return path_; }
  /// Sends a line and returns the answer.
  std::string ask(const std::string& request) {
    std::fputs((request + "\n").c_str(), input_);
    std::fflush(input_);
    return line();
  }
  void set_mute(bool mute) { ask(mute ? "mute" : "unmute"); }
  /// Ends the program. The host's end hangs up.
  void unplug() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
    std::fclose(input_);
    std::fclose(output_);
  }

private:
  std::string line() {
    std::string text;
    for (int c = 0; (c = std::fgetc(output_)) != EOF && c != '\n';)
      text.push_back(static_cast<char>(c));
    return text;
  }

  pid_t pid_ = 0;
  std::FILE* input_ = nullptr;
  std::FILE* output_ = nullptr;
  std::string path_;
};

} // namespace nendo::test
