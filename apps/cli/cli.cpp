#include "cli/cli.hpp"

#include <csignal>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>

#include <nlohmann/json.hpp>
#include <sched.h>
#include <sys/auxv.h>
#include <unistd.h>

namespace nendo::cli {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free); // or a signal handler must not touch it

constexpr const char* variable = "GLIBC_TUNABLES";
constexpr const char* tunable = "glibc.malloc.hugetlb";

bool must_be_asked_for() {
  std::string modes; // the one in effect in brackets
  std::getline(std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"), modes);
  return modes.find("[madvise]") != std::string::npos;
}

void start_again(char** argv) {
  const char* const before = std::getenv(variable);
  const std::string others = before == nullptr ? "" : before;
  if (others.find(tunable) != std::string::npos || !must_be_asked_for()) return;
  // By its own path, and not /proc/self/exe, which would become the process's name.
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  const std::string all = (others.empty() ? "" : others + ":") + tunable + "=1";
  ::setenv(variable, all.c_str(), 1);
  ::execv(program.c_str(), argv);
  others.empty() ? ::unsetenv(variable) : ::setenv(variable, others.c_str(), 1);
}

void on_stop_signal(int) {
  request_stop();
}

} // namespace

int report(const Error& error) {
  std::cerr << "nendo: " << error.message << std::endl;
  return static_cast<int>(error.code);
}

void note(std::string_view text) {
  std::cerr << "nendo: " << text << std::endl;
}

std::string json_text(const nlohmann::ordered_json& object) {
  return object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void print_line(const nlohmann::ordered_json& object) {
  std::cout << json_text(object) << std::endl;
}

const std::atomic<bool>& stop_requested() noexcept {
  return stop;
}

void request_stop() noexcept {
  stop.store(true, std::memory_order_relaxed);
}

void install_stop_signals() noexcept {
  struct sigaction action{};
  action.sa_handler = on_stop_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND); // the second signal finds the default action
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction inherited{};
    sigaction(signal, nullptr, &inherited);
    if (signal == SIGHUP && inherited.sa_handler == SIG_IGN) continue; // nohup
    sigaction(signal, &action, nullptr);
  }
}

std::filesystem::path shipped_model(std::string_view file_name) {
  std::error_code failed;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
  return program.parent_path().parent_path() / "share" / "nendo" / "models" / file_name;
}

void use_huge_pages(char** argv) noexcept {
  // A program with capabilities of its own starts without that variable, each time.
  if (::getauxval(AT_SECURE) != 0) return;
  try {
    start_again(argv);
  } catch (const std::exception&) { // no /proc, or no memory: the program says so itself
  }
}

Result<TwoProcessors> two_processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) < 2)
    return Error{Errc::failed,
                 "needs two processors, and this process may use only one; see taskset(1)"};
  TwoProcessors processors{-1, -1};
  for (int n = 0; processors.second < 0; ++n) {
    if (!CPU_ISSET(static_cast<std::size_t>(n), &allowed)) continue;
    (processors.first < 0 ? processors.first : processors.second) = n;
  }
  return processors;
}

} // namespace nendo::cli
