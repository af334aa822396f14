#pragma once
// The run delay of a thread: how long it was ready to run while other threads had its CPU, as the
// kernel counts it. It distinguishes preemption from a machine that stood still.

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include <sys/types.h>

#include <nendo/base/units.hpp>

namespace nendo::stress {

/// Returns the waiting time in a line of /proc/<pid>/task/<tid>/schedstat, which has the time on
/// the CPU, the time waiting for it, both in nanoseconds, and the time slices. Pure.
std::optional<std::chrono::nanoseconds> parse_run_delay(const std::string& schedstat);

/// Another thread takes the samples, so that the thread itself makes no system call.
class RunDelay {
public:
  /// `thread` is a thread of this process.
  explicit RunDelay(pid_t thread);

  /// Reads the kernel's count and stores it. That reads a file and takes some microseconds.
  void sample();
  /// Returns how long the thread waited from the last sample before `from` to the newest one, which
  /// is no less than since `from`. If `from` is before the first sample, that is all the time that
  /// it ever waited. Returns nothing if the kernel does not say, or if `from` is before the samples
  /// that are kept.
  std::optional<std::chrono::nanoseconds> since(HostTime from) const noexcept;

private:
  struct Sample {
    HostTime time{};
    std::chrono::nanoseconds waited{};
  };
  static constexpr std::size_t kept = 1024;

  std::string path_;
  std::array<Sample, kept> samples_{}; ///< a ring; sample n is at n % kept
  std::uint64_t count_ = 0;
};

} // namespace nendo::stress
