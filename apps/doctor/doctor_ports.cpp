// The checks of ports and SpaceMice: whether they may be opened, are used by others, and are fast
// enough.

#include "doctor/doctor.hpp"

#include <algorithm>
#include <array>

#include <nendo/base/advised_command.hpp>

namespace nendo::doctor {
namespace {

using driver::DeviceCandidate;
using driver::DeviceKind;
using namespace std::chrono_literals;

using Findings = std::vector<Finding>;

bool runs(const PortFacts& facts, std::string_view program) {
  return std::find(facts.grabbers.begin(), facts.grabbers.end(), program) != facts.grabbers.end();
}

bool is_input(const DeviceCandidate& candidate) noexcept {
  return candidate.kind == DeviceKind::input_device;
}

/// A port that nothing identifies as a glove's may serve another purpose. It gives warnings only,
/// unless it is `likely` to be a glove's. So does a SpaceMouse, which may serve other programs.
Severity severity_for(const DeviceCandidate& candidate, bool likely) {
  const bool is_failure = (candidate.identified || likely) && !is_input(candidate);
  return is_failure ? Severity::failure : Severity::warning;
}

void check_presence(const PortFacts& facts, Findings& found) {
  if (!std::ranges::all_of(facts.candidates, is_input)) return;
  found.push_back({Severity::warning, "presence", "",
                   "no serial port and no USB glove is plugged in",
                   "plug the glove in (`nendo devices --watch` reports it); a container needs "
                   "access to its device"});
}

void check_nodes(const PortFacts& facts, Findings& found) {
  for (const DeviceCandidate& candidate : facts.candidates) {
    if (!candidate.node_missing || candidate.kind == DeviceKind::portless_adapter) continue;
    found.push_back(
        {severity_for(candidate, candidate.usb.has_value()), "node", candidate.device,
         "the kernel has found it, but its device node is missing, so no program can open it",
         candidate.remedy});
  }
}

void check_permission(const PortFacts& facts, Findings& found) {
  for (const DeviceCandidate& candidate : facts.candidates) {
    if (candidate.may_open || candidate.access.empty()) continue;
    if (candidate.kind == DeviceKind::portless_adapter) continue; // not what would be opened
    found.push_back({severity_for(candidate, candidate.usb.has_value()), "permission",
                     candidate.device, "only " + candidate.access + " may open it",
                     candidate.remedy});
  }
}

void check_portless(const PortFacts& facts, Findings& found) {
  for (const DeviceCandidate& candidate : facts.candidates) {
    if (candidate.kind != DeviceKind::portless_adapter) continue;
    if (runs(facts, "brltty")) {
      found.push_back({Severity::failure, "portless", candidate.device,
                       "brltty, which drives Braille displays, took " + candidate.description,
                       "sudo systemctl mask --now brltty brltty-udev, then plug it in again"});
    } else {
      found.push_back({Severity::failure, "portless", candidate.device,
                       candidate.description + " has no serial port: its kernel driver is missing",
                       candidate.remedy});
    }
  }
}

void check_holders(const PortFacts& facts, Findings& found) {
  for (const DeviceCandidate& candidate : facts.candidates) {
    if (is_input(candidate)) continue; // several programs may read it
    for (const auto& holder : candidate.holders) {
      const std::string pid = std::to_string(holder.pid);
      found.push_back(
          {severity_for(candidate, false), "holder", candidate.device,
           "is held by " + holder.name + (holder.pid > 0 ? " (pid " + pid + ")" : ""),
           holder.pid > 0 ? "close that program, or: kill " + pid : "close that program"});
    }
  }
}

/// Finds programs that open a new adapter and talk to it, because it may be a modem or a Braille
/// display.
void check_grabbers(const PortFacts& facts, Findings& found) {
  struct Grabber {
    std::string_view name;
    std::string_view harm;
    std::string_view units;
    bool follows_rules; ///< it leaves devices alone that our udev rules mark
  };
  constexpr std::array grabbers{
      Grabber{"ModemManager", "holds a new adapter for 10 to 20 s and sends modem commands to it",
              "ModemManager", true},
      Grabber{"brltty", "may use an adapter as that of a Braille display", "brltty brltty-udev",
              false},
  };
  const auto unmarked = std::find_if(
      facts.candidates.begin(), facts.candidates.end(), [](const DeviceCandidate& candidate) {
        return candidate.kind == DeviceKind::serial_port && candidate.usb && !candidate.left_alone;
      });
  if (unmarked == facts.candidates.end()) return;
  for (const Grabber& grabber : grabbers) {
    if (!runs(facts, grabber.name)) continue;
    const std::string mask = "sudo systemctl mask --now " + std::string(grabber.units);
    const std::string bind = as_root("udev bind " + shell_word(unmarked->device) + " --as right");
    found.push_back({Severity::warning, "grabber", unmarked->device,
                     std::string(grabber.name) + " runs and " + std::string(grabber.harm),
                     grabber.follows_rules ? bind + " (or --as left), or " + mask : mask});
  }
}

void check_latency(const PortFacts& facts, Findings& found) {
  for (const DeviceCandidate& candidate : facts.candidates) {
    if (!candidate.latency_timer || *candidate.latency_timer <= 1ms) continue;
    found.push_back({Severity::warning, "latency_timer", candidate.device,
                     "the adapter delays replies by " +
                         std::to_string(candidate.latency_timer->count()) + " ms",
                     driver::latency_timer_remedy(candidate.device)});
  }
}

constexpr std::array port_checks{check_presence, check_nodes,    check_permission, check_portless,
                                 check_holders,  check_grabbers, check_latency};

} // namespace

std::vector<Finding> diagnose_ports(const PortFacts& facts) {
  Findings found;
  for (const auto check : port_checks)
    check(facts, found);
  return found;
}

PortFacts read_ports() {
  PortFacts facts{driver::find_devices(), driver::running_port_grabbers()};
  // A mouse that only the display server may read is as it should be.
  std::erase_if(facts.candidates, [](const DeviceCandidate& candidate) {
    return is_input(candidate) && !candidate.identified;
  });
  return facts;
}

Examination check_ports() {
  const PortFacts facts = read_ports();
  Examination examination{diagnose_ports(facts), {}};
  for (const DeviceCandidate& candidate : facts.candidates)
    examination.looked_at.push_back(candidate.device);
  if (std::ranges::all_of(facts.candidates, is_input))
    examination.looked_at.emplace_back("serial ports and USB gloves (none)");
  examination.looked_at.emplace_back("programs that take ports");
  return examination;
}

} // namespace nendo::doctor
