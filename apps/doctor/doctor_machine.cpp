// The checks of the machine: whether the loop can be punctual here, and the udev rules are current.
// The facts are read from files of /proc, /sys and /etc below a root.

#include "doctor/doctor.hpp"

#include <array>
#include <charconv>
#include <ctime>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>

#include <nendo/base/advised_command.hpp>
#include <nendo/base/number_in.hpp>
#include <nendo/flow/realtime.hpp>

namespace nendo::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// Returns the first thousand lines of a file, or nothing if there is no such file.
std::vector<std::string> lines_of(const fs::path& path) {
  constexpr std::size_t max_lines = 1000;
  std::vector<std::string> lines;
  std::ifstream file(path);
  for (std::string line; lines.size() < max_lines && std::getline(file, line);)
    lines.push_back(line);
  return lines;
}

/// Returns the soft limit in a line such as "Max realtime priority     0        0  " (proc(5)).
std::optional<std::uint64_t> limit_in(const std::string& line, std::string_view name) {
  if (!line.starts_with(name)) return std::nullopt;
  std::istringstream words(line.substr(name.size()));
  std::string soft;
  words >> soft;
  return soft == "unlimited" ? unlimited : number_in<std::uint64_t>(soft);
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

/// Returns whether the kernel's list of timers reports fine timers. Where only root may read
/// the list, the clock's resolution is used: without fine timers it is the length of a tick.
std::optional<bool> has_fine_timers(const fs::path& root) {
  for (const std::string& line : lines_of(root / "proc/timer_list")) {
    const std::size_t at = line.find(".hres_active");
    if (at != std::string::npos) return line.find('1', at) != std::string::npos;
  }
  timespec resolution{};
  if (root != "/" || ::clock_getres(CLOCK_MONOTONIC, &resolution) != 0) return std::nullopt;
  return resolution.tv_sec == 0 && resolution.tv_nsec == 1;
}

using Findings = std::vector<Finding>;

void warn(Findings& found, std::string_view check, const std::string& what,
          const std::string& remedy) {
  found.push_back({Severity::warning, check, "", what, remedy});
}

/// Returns commands that write the file of limits, if it is missing, and join its group.
std::string limits_remedy(const MachineFacts& facts) {
  const std::string join = "sudo usermod -aG audio $USER, then log in again";
  if (facts.has_limits_file) return join;
  return "printf '@audio - rtprio 99\\n@audio - memlock unlimited\\n' | sudo tee "
         "/etc/security/limits.d/nendo.conf; " +
         join;
}

void check_priority(const MachineFacts& facts, Findings& found) {
  // The readers of gloves run above the loop.
  const std::uint64_t wanted = flow::reader_priority(flow::usual_priority);
  if (facts.has_priority || !facts.priority_limit || *facts.priority_limit >= wanted) return;
  warn(found, "realtime",
       "the max real-time priority is " + std::to_string(*facts.priority_limit) +
           " (ulimit -r), and the loop needs " + std::to_string(wanted) + "; it is less punctual",
       limits_remedy(facts));
}

void check_memory(const MachineFacts& facts, Findings& found) {
  if (facts.has_memory || !facts.memory_limit || *facts.memory_limit == unlimited) return;
  warn(found, "memlock",
       "only " + std::to_string(*facts.memory_limit / 1024) +
           " KiB of memory may be locked (ulimit -l), so --mlockall is refused",
       limits_remedy(facts));
}

void check_governor(const MachineFacts& facts, Findings& found) {
  for (const auto& [governor, cpus] : facts.governors) {
    if (governor == "performance") continue;
    warn(found, "governor",
         "the governor " + governor + " of " + std::to_string(cpus) +
             " CPUs lowers their frequency while they wait for the next tick",
         "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor");
  }
}

void check_timers(const MachineFacts& facts, Findings& found) {
  if (facts.fine_timers.value_or(true)) return;
  warn(found, "timers",
       "the kernel has no high-resolution timers, so ticks are late by milliseconds",
       "boot without highres=off, or use a kernel with CONFIG_HIGH_RES_TIMERS, such as Debian's");
}

void check_rules(const MachineFacts& facts, Findings& found) {
  if (!facts.has_udev) return; // a container, whose devices the host identifies
  for (const udev::RuleFile& file : facts.rules) {
    if (file.state == udev::RuleState::current) continue;
    const std::string path = file.path.string();
    Finding finding{Severity::warning, "rules", path, "", as_root("udev install")};
    switch (file.state) {
    case udev::RuleState::outdated:
      finding.what = "is of another version of nendo";
      break;
    case udev::RuleState::foreign:
      finding.what = "is not nendo's and hides nendo's rules";
      finding.remedy = "sudo mv " + path + " " + path + ".old && " + as_root("udev install");
      break;
    default:
      finding.what = "is not installed, so gloves and SpaceMice may need root or a group";
    }
    found.push_back(std::move(finding));
  }
}

constexpr std::array machine_checks{check_priority, check_memory, check_governor, check_timers,
                                    check_rules};

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

std::vector<Finding> diagnose_machine(const MachineFacts& facts) {
  Findings found;
  for (const auto check : machine_checks)
    check(facts, found);
  return found;
}

Examination check_machine() {
  return {diagnose_machine(read_machine("/")),
          {"limits of real-time priority and locked memory", "CPU frequency governors",
           "the kernel's timers", "udev rules"}};
}

} // namespace nendo::doctor
