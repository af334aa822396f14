#pragma once
// Where a measurement was taken, without which its figures mean nothing.

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

/// Reads /proc and /sys; what they do not say stays empty.
Environment describe_environment();

/// Time that the host gave to others while this machine wanted it, since it began, all CPUs;
/// nothing if the kernel does not count it. In clock ticks of 10 ms, so that short gaps are not in
/// it.
std::optional<double> stolen_s();

} // namespace nendo::stress
