// The checks of the machine: whether the loop can be punctual here, and the udev rules are in
// force.

#include "doctor/doctor.hpp"

#include <array>
#include <limits>

#include <nendo/base/advised_command.hpp>
#include <nendo/flow/realtime.hpp>

namespace nendo::doctor {
namespace {

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
       "a real-time priority of " + std::to_string(wanted) + " is not allowed, " +
           std::to_string(*facts.priority_limit) + " is (ulimit -r); the loop is less punctual",
       limits_remedy(facts));
}

void check_memory(const MachineFacts& facts, Findings& found) {
  constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
  if (facts.has_memory || !facts.memory_limit || *facts.memory_limit == unlimited) return;
  warn(found, "memlock",
       "memory may be locked up to " + std::to_string(*facts.memory_limit / 1024) +
           " KiB only (ulimit -l), so --mlockall is refused",
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
  warn(found, "timers", "the kernel has no high-resolution timers: ticks are late by milliseconds",
       "boot without highres=off, or a kernel built with CONFIG_HIGH_RES_TIMERS, like Debian's");
}

void check_rules(const MachineFacts& facts, Findings& found) {
  if (!facts.has_udev) return; // a container: whoever hands devices in says what they are
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
      finding.what = "is not installed: gloves need root, a group, or luck";
    }
    found.push_back(std::move(finding));
  }
}

constexpr std::array machine_checks{check_priority, check_memory, check_governor, check_timers,
                                    check_rules};

} // namespace

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
