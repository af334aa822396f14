#include "bench/cyclictest.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nendo/base/number_in.hpp>

namespace nendo::bench {

Result<Cyclictest> Cyclictest::start(unsigned cpu, unsigned seconds, unsigned interval_us) {
  // Inherited by the child on purpose, which finds it under its number.
  const int file = ::memfd_create("cyclictest", 0);
  if (file < 0) return Error{Errc::failed, std::string("no memory file: ") + std::strerror(errno)};
  std::array<std::string, 11> words{"cyclictest",
                                    "--threads=1",
                                    "--priority=80",
                                    "--mlockall",
                                    "--quiet",
                                    "--interval=" + std::to_string(interval_us),
                                    "--affinity=" + std::to_string(cpu),
                                    "--duration=" + std::to_string(seconds),
                                    "--histogram=20000",
                                    "--json=/proc/self/fd/" + std::to_string(file),
                                    "--distance=0"};
  std::array<char*, words.size() + 1> argv{};
  for (std::size_t k = 0; k < words.size(); ++k)
    argv[k] = words[k].data();
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return Cyclictest(child, file);
  ::close(file);
  return Error{Errc::failed, std::string("cyclictest: ") + std::strerror(error) +
                                 "; install it: sudo apt-get install rt-tests"};
}

Cyclictest::Cyclictest(Cyclictest&& other) noexcept
    : child_(std::exchange(other.child_, 0)), file_(std::exchange(other.file_, -1)) {}

Cyclictest::~Cyclictest() {
  if (child_ > 0) {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  if (file_ >= 0) ::close(file_);
}

Result<flow::Histogram> Cyclictest::finish() {
  int status = 0;
  while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = 0;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    return Error{Errc::failed, "cyclictest failed; it needs root or real-time rights"};
  std::string text;
  std::array<char, 4096> chunk{};
  ::lseek(file_, 0, SEEK_SET);
  for (ssize_t got = 0; (got = ::read(file_, chunk.data(), chunk.size())) > 0;)
    text.append(chunk.data(), static_cast<std::size_t>(got));
  return parse_cyclictest(text);
}

Result<flow::Histogram> parse_cyclictest(const std::string& json) {
  const Error bad{Errc::failed, "cyclictest wrote a report that has no histogram"};
  const auto report = nlohmann::json::parse(json, nullptr, false);
  if (!report.is_object() || !report.contains("thread") || !report["thread"].contains("0"))
    return bad;
  const auto& thread = report["thread"]["0"];
  if (!thread.is_object() || !thread.contains("histogram") || !thread["histogram"].is_object())
    return bad;
  flow::Histogram histogram;
  for (const auto& [key, count] : thread["histogram"].items()) {
    const auto us = number_in<long long>(key);
    if (!us || !count.is_number_unsigned()) return bad;
    histogram.record(std::chrono::microseconds(*us), count.get<std::uint64_t>());
  }
  if (histogram.count() == 0) return bad;
  return histogram;
}

} // namespace nendo::bench
