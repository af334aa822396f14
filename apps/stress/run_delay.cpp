#include "stress/run_delay.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>

namespace nendo::stress {

std::optional<std::chrono::nanoseconds> parse_run_delay(const std::string& schedstat) {
  const std::size_t space = schedstat.find(' ');
  if (space == std::string::npos) return std::nullopt;
  std::int64_t waited_ns = 0;
  const char* const begin = schedstat.data() + space + 1;
  const char* const end = schedstat.data() + schedstat.size();
  const auto [stopped, error] = std::from_chars(begin, end, waited_ns);
  if (error != std::errc{} || stopped == end || *stopped != ' ' || waited_ns < 0)
    return std::nullopt;
  return std::chrono::nanoseconds(waited_ns);
}

RunDelay::RunDelay(pid_t thread)
    : path_("/proc/self/task/" + std::to_string(thread) + "/schedstat") {}

void RunDelay::sample() {
  std::ifstream file(path_);
  std::string line;
  if (!std::getline(file, line)) return;
  const auto waited = parse_run_delay(line);
  if (!waited) return;
  samples_[count_ % kept] = {HostClock::now(), *waited};
  ++count_;
}

std::optional<std::chrono::nanoseconds> RunDelay::since(HostTime from) const noexcept {
  if (count_ == 0) return std::nullopt;
  const Sample& newest = samples_[(count_ - 1) % kept];
  const std::uint64_t held = std::min<std::uint64_t>(count_, kept);
  for (std::uint64_t back = 1; back <= held; ++back) {
    const Sample& sample = samples_[(count_ - back) % kept];
    if (sample.time <= from) return newest.waited - sample.waited;
  }
  if (held == count_) return newest.waited;
  return std::nullopt;
}

} // namespace nendo::stress
