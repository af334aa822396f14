// What the machine says of itself, from the files of /proc, /sys and /etc below a root.

#include <charconv>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>

#include <ctime>

#include "doctor/doctor.hpp"

namespace nendo::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// Returns the first thousand lines of a file, or nothing if there is no such file.
std::vector<std::string> lines_of(const fs::path& path) {
  constexpr std::size_t most = 1000;
  std::vector<std::string> lines;
  std::ifstream file(path);
  for (std::string line; lines.size() < most && std::getline(file, line);)
    lines.push_back(line);
  return lines;
}

/// Returns the soft limit in a line such as "Max realtime priority     0        0  " (proc(5)).
std::optional<std::uint64_t> limit_in(const std::string& line, std::string_view name) {
  if (!line.starts_with(name)) return std::nullopt;
  std::istringstream words(line.substr(name.size()));
  std::string soft;
  words >> soft;
  if (soft == "unlimited") return unlimited;
  std::uint64_t value = 0;
  const char* const end = soft.data() + soft.size();
  const auto [stopped, error] = std::from_chars(soft.data(), end, value);
  return error == std::errc{} && stopped == end ? std::optional(value) : std::nullopt;
}

void read_limits(const fs::path& root, MachineFacts& facts) {
  for (const std::string& line : lines_of(root / "proc/self/limits")) {
    if (const auto limit = limit_in(line, "Max realtime priority")) facts.priority_limit = limit;
    if (const auto limit = limit_in(line, "Max locked memory")) facts.memory_limit = limit;
  }
  for (const std::string& line : lines_of(root / "proc/self/status")) {
    constexpr std::string_view name = "CapEff:\t"; // a mask, by capabilities(7)
    if (!line.starts_with(name)) continue;
    constexpr unsigned ipc_lock = 14;
    constexpr unsigned sys_nice = 23;
    std::uint64_t mask = 0;
    std::from_chars(line.data() + name.size(), line.data() + line.size(), mask, 16);
    facts.has_memory = (mask >> ipc_lock & 1U) != 0;
    facts.has_priority = (mask >> sys_nice & 1U) != 0;
  }
  std::error_code failed;
  facts.has_limits_file = fs::exists(root / "etc/security/limits.d/nendo.conf", failed);
}

void read_governors(const fs::path& root, MachineFacts& facts) {
  constexpr int max_cpus = 4096;
  for (int cpu = 0; cpu < max_cpus; ++cpu) {
    const fs::path folder = root / "sys/devices/system/cpu" / ("cpu" + std::to_string(cpu));
    std::error_code failed;
    if (!fs::exists(folder, failed)) break;
    const auto lines = lines_of(folder / "cpufreq/scaling_governor");
    if (!lines.empty()) ++facts.governors[lines.front()];
  }
}

/// Returns whether the kernel's list of timers says that they are fine. Where only root may read
/// the list, the clock's resolution says it: without fine timers it is the length of a tick.
std::optional<bool> has_fine_timers(const fs::path& root) {
  for (const std::string& line : lines_of(root / "proc/timer_list")) {
    const std::size_t at = line.find(".hres_active");
    if (at != std::string::npos) return line.find('1', at) != std::string::npos;
  }
  timespec resolution{};
  if (root != "/" || ::clock_getres(CLOCK_MONOTONIC, &resolution) != 0) return std::nullopt;
  return resolution.tv_sec == 0 && resolution.tv_nsec == 1;
}

} // namespace

MachineFacts read_machine(const fs::path& root) {
  MachineFacts facts;
  read_limits(root, facts);
  read_governors(root, facts);
  facts.fine_timers = has_fine_timers(root);
  std::error_code failed;
  facts.has_udev = fs::exists(root / "run/udev", failed);
  facts.rules = udev::rules_in_force(root);
  return facts;
}

} // namespace nendo::doctor
