#include "cli/cli.hpp"

#include <array>
#include <charconv>
#include <csignal>
#include <iostream>

namespace nendo::cli {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free); // or a signal handler must not touch it

void on_stop_signal(int) {
  stop.store(true, std::memory_order_relaxed);
}

} // namespace

int report(const Error& error) {
  std::cerr << "nendo: " << error.message << std::endl;
  return static_cast<int>(error.code);
}

void note(std::string_view text) {
  std::cerr << "nendo: " << text << std::endl;
}

const std::atomic<bool>& stop_requested() noexcept {
  return stop;
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

Result<double> parse_duration(const std::string& text, const std::string& option) {
  struct Unit {
    std::string_view name;
    double seconds;
  };
  constexpr std::array<Unit, 5> units{
      {{"", 1.0}, {"s", 1.0}, {"m", 60.0}, {"h", 3600.0}, {"d", 86'400.0}}};
  constexpr double most_s = 1e7;
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  const std::string_view suffix(stopped, static_cast<std::size_t>(end - stopped));
  for (const Unit& unit : units) {
    const double seconds = value * unit.seconds;
    if (error == std::errc{} && suffix == unit.name && seconds > 0.0 && seconds <= most_s)
      return seconds;
  }
  return Error{Errc::usage, option + " " + text + ": use seconds above 0, or 10m, 2h, 1d"};
}

} // namespace nendo::cli
