#include "stress/load.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace nendo::stress {
namespace {

[[noreturn]] void compute() {
  volatile std::uint64_t state = 88172645463325252U;
  for (;;) {
    std::uint64_t x = state; // G. Marsaglia, "Xorshift RNGs", 2003
    x ^= x << 13U;
    x ^= x >> 7U;
    x ^= x << 17U;
    state = x;
  }
}

[[noreturn]] void copy_memory() {
  constexpr std::size_t bytes = std::size_t{32} << 20U;
  const auto here = std::make_unique<std::byte[]>(bytes);
  const auto there = std::make_unique<std::byte[]>(bytes);
  for (unsigned round = 0;; ++round) {
    here[round % bytes] = static_cast<std::byte>(round); // so that no copy can be left out
    std::memcpy(there.get(), here.get(), bytes);
    std::memcpy(here.get(), there.get(), bytes);
  }
}

[[noreturn]] void write_file() {
  std::error_code failed;
  const auto folder = std::filesystem::temp_directory_path(failed);
  // A file without a name is gone with its last user.
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  static const std::array<std::byte, 65536> block{};
  constexpr off_t max_bytes = off_t{16} << 20U;
  for (off_t at = 0;; at = (at + static_cast<off_t>(block.size())) % max_bytes) {
    if (::pwrite(file, block.data(), block.size(), at) < 0 || ::fdatasync(file) != 0)
      ::usleep(10'000); // with a full disk, it must not keep the processor busy instead
  }
}

struct Kind {
  std::string_view name;
  void (*work)();
};
constexpr std::array kinds_known{Kind{"cpu", compute}, Kind{"mem", copy_memory},
                                 Kind{"io", write_file}};

[[noreturn]] void be_worker(const Kind& kind, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(0); // the parent died before prctl()
  // Ctrl-C reaches the whole group. The parent ends the workers later.
  ::signal(SIGINT, SIG_IGN);
  ::signal(SIGTERM, SIG_DFL);
  const sched_param ordinary{};
  ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  kind.work();
  ::_exit(0);
}

} // namespace

Result<std::vector<std::string>> parse_load(const std::string& text) {
  std::vector<std::string> kinds;
  for (std::string_view rest = text; !text.empty();) {
    const std::size_t comma = rest.find(',');
    const std::string_view name = rest.substr(0, comma);
    if (std::none_of(kinds_known.begin(), kinds_known.end(),
                     [&](const Kind& kind) { return kind.name == name; })) {
      return Error{Errc::usage, "--load " + text + ": use cpu, mem, io, or several with commas"};
    }
    kinds.emplace_back(name);
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  return kinds;
}

Result<Load> Load::start(const std::vector<std::string>& kinds) {
  Load load;
  const pid_t parent = ::getpid();
  for (const std::string& name : kinds) {
    const auto* kind = std::find_if(kinds_known.begin(), kinds_known.end(),
                                    [&](const Kind& known) { return known.name == name; });
    const long workers = name == "cpu" ? std::max(1L, ::sysconf(_SC_NPROCESSORS_ONLN)) : 1L;
    for (long k = 0; k < workers; ++k) {
      const pid_t worker = ::fork();
      if (worker == 0) be_worker(*kind, parent);
      if (worker < 0) {
        return Error{Errc::failed,
                     "--load " + name + ": cannot start a process: " + std::strerror(errno)};
      }
      load.workers_.push_back(worker);
    }
  }
  return load;
}

Load::~Load() {
  for (const pid_t worker : workers_)
    ::kill(worker, SIGKILL);
  for (const pid_t worker : workers_) {
    while (::waitpid(worker, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
}

} // namespace nendo::stress
