#pragma once
// Runs the nendo program as a user would, and returns its output.

#include <array>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/eventually.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace nendo::test {

struct Finished {
  int exit_code = -1; ///< 128 + n if signal n ended it
  std::string out;
  std::string err;
  double seconds = 0.0;
};

/// A running program. The destructor kills it if it still runs.
class Program {
public:
  /// `out_fd` becomes its standard output; with -1 that is a file, which wait() returns.
  explicit Program(std::vector<std::string> arguments, int out_fd = -1)
      : started_(std::chrono::steady_clock::now()) {
    arguments.insert(arguments.begin(), NENDO_PROGRAM);
    std::vector<char*> argv;
    for (auto& argument : arguments)
      argv.push_back(argument.data());
    argv.push_back(nullptr);
    const std::string out = (folder_.path() / "out").string();
    const std::string err = (folder_.path() / "err").string();
    pid_ = ::fork();
    if (pid_ != 0) return;
    // Between fork and exec, only calls are made that are safe in a child of a threaded program.
    ::dup2(::open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
    if (out_fd < 0) out_fd = ::open(out.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ::dup2(out_fd, STDOUT_FILENO);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600), STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ~Program() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void signal(int number) const { ::kill(pid_, number); }
  pid_t id() const noexcept { return pid_; }
  /// Waits until the program has a handler for a signal. Returns false if it has none in time.
  bool gets_handler_of(int number) const {
    return eventually([&] { return catches(number); });
  }
  /// Waits until a run reports its progress, on standard error or, as JSON, on standard output.
  bool reports_progress() const {
    return eventually([&] {
      return err_so_far().find("samples") != std::string::npos ||
             contents(folder_.path() / "out").find("progress") != std::string::npos;
    });
  }
  std::string err_so_far() const { return contents(folder_.path() / "err"); }

  Finished wait(std::chrono::seconds patience = std::chrono::seconds(240)) {
    Finished finished;
    int status = 0;
    while (::waitpid(pid_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() - started_ > patience) {
        finished.err = "the test lost its patience";
        return finished;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    pid_ = 0;
    finished.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    finished.out = contents(folder_.path() / "out");
    finished.err = contents(folder_.path() / "err");
    finished.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
    return finished;
  }

private:
  /// Whether the program, no longer the test that forked, has a handler for a signal.
  bool catches(int number) const {
    const std::string folder = "/proc/" + std::to_string(pid_);
    std::error_code gone;
    if (std::filesystem::read_symlink(folder + "/exe", gone).filename() != "nendo") return false;
    const std::string status = contents(folder + "/status");
    const auto at = status.find("SigCgt:");
    return at != std::string::npos &&
           (std::stoull(status.substr(at + 7), nullptr, 16) >> (number - 1) & 1U) != 0;
  }

  TemporaryFolder folder_;
  std::chrono::steady_clock::time_point started_;
  pid_t pid_ = 0;
};

inline Finished nendo(std::vector<std::string> arguments) {
  return Program(std::move(arguments)).wait();
}

/// Waits until there is a file or link. Returns false if there is none within ten seconds.
inline bool appears(const std::filesystem::path& path) {
  for (int turn = 0; turn < 2000 && !std::filesystem::exists(path); ++turn)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return std::filesystem::exists(path);
}

/// A CyberGlove emulated by a program of its own, ready when this is constructed.
class EmulatedGlove {
public:
  EmulatedGlove(const std::filesystem::path& link, const std::string& hand,
                const std::string& sensors)
      : program_({"emulate", "--link", link.string(), "--hand", hand, "--sensors", sensors}) {
    appears(link);
  }

private:
  Program program_;
};

/// Returns whether an error is one line that begins with the program's name and mentions `what`.
inline bool is_one_line_about(const std::string& err, std::string_view what) {
  return lines_of(err).size() == 1 && err.starts_with("nendo: ") &&
         err.find(what) != std::string::npos;
}

} // namespace nendo::test
