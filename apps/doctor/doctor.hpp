#pragma once
// The checks of `nendo doctor`. A check is a function from the machine's facts to findings. Checks
// are listed in tables, one for each subject. A new subject needs a file and a line in
// doctor_command.cpp.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/driver/devices.hpp>
#include <nendo/udev/installed_rules.hpp>

namespace nendo::doctor {

enum class Severity : std::uint8_t {
  warning, ///< works, but not well, or only if no other program interferes
  failure, ///< will not work
};

struct Finding {
  Severity severity = Severity::warning;
  std::string_view check; ///< a stable name, e.g. "permission"
  std::string subject;    ///< e.g. /dev/ttyUSB0; empty: the machine
  std::string what;       ///< what is wrong
  std::string remedy;     ///< the command or action that fixes it
};

/// The findings of a subject's checks, and what they examined.
struct Examination {
  std::vector<Finding> findings;
  std::vector<std::string> looked_at; ///< e.g. "/dev/ttyUSB0", "CPU frequency governors"
};

/// The facts that the checks of ports use.
struct PortFacts {
  std::vector<driver::DeviceCandidate> candidates; ///< ports, USB gloves, SpaceMice
  std::vector<std::string> grabbers;               ///< driver::running_port_grabbers()
};

/// Reads the facts of this machine. Blocks for less than a second.
PortFacts read_ports();
/// Returns all findings about ports and devices. Pure.
std::vector<Finding> diagnose_ports(const PortFacts& facts);
/// Examines this machine's ports now. Blocks for less than a second.
Examination check_ports();

/// The facts that the checks of the machine use. A fact that is unknown gives no finding.
struct MachineFacts {
  std::optional<std::uint64_t> priority_limit; ///< RLIMIT_RTPRIO of this process
  std::optional<std::uint64_t> memory_limit;   ///< RLIMIT_MEMLOCK in bytes; the largest: unlimited
  bool has_priority = false;                   ///< CAP_SYS_NICE, for which the limit does not count
  bool has_memory = false;                     ///< CAP_IPC_LOCK: the same
  bool has_limits_file = false;                ///< /etc/security/limits.d/nendo.conf is there
  std::map<std::string, int> governors;        ///< each frequency governor, with its number of CPUs
  std::optional<bool> fine_timers;             ///< the kernel's timers are better than its tick
  bool has_udev = false;                       ///< udev runs
  std::vector<udev::RuleFile> rules;
};

/// Reads the facts from /proc, /sys, /run and /etc below `root`. Blocks briefly.
MachineFacts read_machine(const std::filesystem::path& root);
/// Returns all findings about the machine: limits, clocks, rules. Pure.
std::vector<Finding> diagnose_machine(const MachineFacts& facts);
/// Examines this machine now.
Examination check_machine();

/// A manifest of Nendo's layer in a folder of OpenXR's loader.
struct LayerManifest {
  std::filesystem::path path;
  std::string problem; ///< why the loader cannot load the layer; empty: it can
};
/// The facts that the checks of nendo-openxr use.
struct OpenXrFacts {
  std::vector<LayerManifest> manifests;
  std::optional<std::string> segment; ///< NENDO_XR
  bool is_disabled = false;           ///< DISABLE_NENDO_XR is set
};

/// Reads the manifests in `folders`, loads the libraries that those of Nendo's layer name, and
/// reads the environment. Blocks briefly.
OpenXrFacts read_openxr(const std::vector<std::filesystem::path>& folders);
/// Returns all findings about the layer. Pure.
std::vector<Finding> diagnose_openxr(const OpenXrFacts& facts);
/// Examines the folders in which OpenXR's loader looks.
Examination check_openxr();

} // namespace nendo::doctor
