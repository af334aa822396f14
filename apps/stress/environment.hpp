#pragma once
// A description of the machine on which a measurement was taken.

#include <cstdint>
#include <optional>
#include <string>

namespace nendo::stress {

struct Environment {
  std::string kernel;      ///< "6.1.0-18-amd64"
  std::string preemption;  ///< "PREEMPT_RT", "PREEMPT_DYNAMIC", "" if the kernel does not say
  std::string processor;   ///< its model name
  unsigned cpus = 0;       ///< online
  bool hypervisor = false; ///< the processor says that it is a virtual one
  std::string governor;    ///< of the first CPU's frequency; empty if there is none
  std::string clock_source;
  std::optional<long> rt_runtime_us; ///< real-time threads' share of each second; -1: no limit
};

/// Reads /proc and /sys. Values that the system does not provide stay empty.
Environment describe_environment();

/// Returns the stolen time since boot, summed over all CPUs: the time that the host gave to others
/// while this virtual machine was ready to run. Returns nothing if the kernel does not count it. It
/// is counted in ticks of 10 ms, so short gaps are not included.
std::optional<double> stolen_s();

} // namespace nendo::stress
