#include "crash_handler.hpp"

#include <array>
#include <atomic>
#include <climits>
#include <cstring>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <nendo/base/files.hpp>

namespace nendo::recording {
namespace {

constexpr std::array<int, 5> crashes{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};

// A signal handler sees nothing but what has static storage.
std::atomic<LastMinute*> kept{nullptr};
std::array<char, PATH_MAX> kept_path{};
std::array<struct sigaction, crashes.size()> before{};
std::atomic<pid_t> writer{0}; // the thread that writes it now
static_assert(std::atomic<LastMinute*>::is_always_lock_free &&
              std::atomic<pid_t>::is_always_lock_free);

void say(std::string_view text) noexcept {
  write_all(STDERR_FILENO, std::as_bytes(std::span(text)));
}

// From here on only calls that signal-safety(7) lists, and gettid(), which is no more than a system
// call.

void write_last_minute(LastMinute& ring) noexcept {
  ring.freeze();
  const int fd = ::open(kept_path.data(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  const bool written = fd >= 0 && ring.write(fd) && ::fsync(fd) == 0;
  say(written ? "nendo: crashed; the last of what it recorded is in "
              : "nendo: crashed; the last of what it recorded could not be written to ");
  say(std::string_view(kept_path.data(), ::strlen(kept_path.data())));
  say("\n");
  if (fd >= 0) ::close(fd);
}

// A slow card takes ten seconds for a full ring; a disk that does not answer is no reason to never
// die.
void wait_for_writer() noexcept {
  constexpr int max_milliseconds = 30'000;
  for (int waited = 0; writer.load() != 0 && waited < max_milliseconds; ++waited)
    ::poll(nullptr, 0, 1);
}

extern "C" void on_crash(int signal) {
  // Whichever thread comes first writes; one that crashes meanwhile must not end the process under
  // it. A crash in here finds nothing to do.
  const pid_t self = ::gettid();
  pid_t other = 0;
  if (writer.compare_exchange_strong(other, self)) {
    if (LastMinute* const ring = kept.exchange(nullptr)) write_last_minute(*ring);
    writer.store(0);
  } else if (other != self) {
    wait_for_writer();
  }
  // The default action takes place when this returns.
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

} // namespace

CrashHandler::CrashHandler(LastMinute& ring, const std::filesystem::path& path) {
  const std::string& name = path.native();
  if (kept.load() != nullptr || name.size() >= kept_path.size()) return;
  std::memcpy(kept_path.data(), name.c_str(), name.size() + 1);
  kept.store(&ring);
  armed_ = true;
  struct sigaction action{};
  action.sa_handler = on_crash;
  // Not SA_RESETHAND: a second thread that crashes in the same way would end the process at once.
  sigemptyset(&action.sa_mask);
  for (std::size_t at = 0; at < crashes.size(); ++at)
    ::sigaction(crashes[at], &action, &before[at]);
}

CrashHandler::~CrashHandler() {
  if (!armed_) return;
  for (std::size_t at = 0; at < crashes.size(); ++at)
    ::sigaction(crashes[at], &before[at], nullptr);
  kept.store(nullptr);
}

} // namespace nendo::recording
