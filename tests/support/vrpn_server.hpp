#pragma once
// Runs tests/driver/vrpn_server.py, a VRPN server that is independent of the driver.

#include <csignal>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/eventually.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace nendo::test {

/// A running server, which accepts connections when this is constructed. The destructor kills it.
class VrpnServer {
public:
  explicit VrpnServer(std::vector<std::string> arguments = {})
      : process_(start(folder_.path() / "out", std::move(arguments))) {
    REQUIRE_MESSAGE(eventually([&] { return said("port ") && said("\n"); }), log());
    port_ = std::atoi(log().substr(5).c_str());
    REQUIRE(port_ > 0);
  }

  void kill() { process_.kill(); }
  void signal(int number) const { ::kill(process_.id, number); }

  int port() const { return port_; }
  std::string at(const std::string& host = "127.0.0.1") const {
    return host + ":" + std::to_string(port_);
  }
  /// What it has said so far: its port, and what clients said.
  std::string log() const { return contents(folder_.path() / "out"); }
  bool said(const std::string& words) const { return log().find(words) != std::string::npos; }

private:
  struct Process {
    explicit Process(pid_t child) : id(child) {}
    ~Process() { kill(); }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;
    void kill() {
      if (id <= 0) return;
      ::kill(id, SIGKILL);
      ::waitpid(id, nullptr, 0);
      id = 0;
    }
    pid_t id;
  };

  static pid_t start(const std::string& out, std::vector<std::string> arguments) {
    // Isolated, and without the site's packages, it starts in half the time.
    arguments.insert(arguments.begin(), {"python3", "-ISu", NENDO_VRPN_SERVER});
    std::vector<char*> argv;
    for (auto& argument : arguments)
      argv.push_back(argument.data());
    argv.push_back(nullptr);
    const pid_t id = ::fork();
    if (id != 0) return id;
    // Between fork and exec, only calls are made that are safe in a child of a threaded program.
    const int file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }

  TemporaryFolder folder_;
  Process process_;
  int port_ = 0;
};

} // namespace nendo::test
