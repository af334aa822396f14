#include "cli/cli.hpp"

#include <csignal>
#include <iostream>

#include <nlohmann/json.hpp>

#include "cli/run_main.hpp"

namespace nendo::cli {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free); // or a signal handler must not touch it

void on_stop_signal(int) {
  request_stop();
}

} // namespace

int report(const Error& error) {
  std::cerr << program_name() << ": " << error.message << std::endl;
  return static_cast<int>(error.code);
}

void note(std::string_view text) {
  std::cerr << program_name() << ": " << text << std::endl;
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

} // namespace nendo::cli
