#pragma once
// An incident is a tick that was late or missed, with the phase that took the time and the cause.
// The run delay of the loop's thread tells causes apart.

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <sys/types.h>

#include <nendo/flow/tick_record.hpp>

namespace nendo::stress {

enum class Phase : std::uint8_t { wake, input, hands, deform, publish };
inline constexpr std::array<std::string_view, 5> phase_names{"wake", "input", "hands", "deform",
                                                             "publish"};

enum class Cause : std::uint8_t {
  host_gap,    ///< no thread of this system ran there: the host, an interrupt, the firmware
  own_work,    ///< the loop's own stages took what they usually take, and that is too much
  input,       ///< draining what the gloves had sent took the time
  preemption,  ///< the loop was ready, and another thread had its CPU
  unexplained, ///< the kernel does not say whether it was ready
};
inline constexpr std::array<std::string_view, 5> cause_names{"host gap", "own work", "input",
                                                             "preemption", "unexplained"};

struct Incident {
  std::uint64_t tick = 0;
  HostTime due{}; ///< the first deadline that was not met
  std::chrono::nanoseconds lateness{};
  std::uint32_t missed = 0; ///< deadlines before the late tick
  Phase phase = Phase::wake;
  std::chrono::nanoseconds phase_time{}; ///< how long it took, as far as after `due`
  Cause cause = Cause::unexplained;
};

/// The usual time of each stage: its 99th percentile. The element for Phase::wake is unused.
using UsualTimes = std::array<std::chrono::nanoseconds, phase_names.size()>;

/// Returns the lateness of `now`, the tick after `before`, and the phase with the largest share in
/// it: the wake-up, or a stage of the previous tick that continued beyond the deadline.
Incident incident_of(const flow::TickRecord& before, const flow::TickRecord& now,
                     std::chrono::nanoseconds period) noexcept;

/// Returns the cause of an incident. `waited` is how long the thread was ready without running
/// since the incident began, or nothing if that is unknown. A thread that waited for half of the
/// phase was preempted. A stage within twice its usual time did its own work. In all other cases no
/// thread of this system ran, and the cause is outside of it.
Cause cause_of(const Incident& incident, const UsualTimes& usual,
               std::optional<std::chrono::nanoseconds> waited) noexcept;

/// Returns the waiting time in a line of /proc/<pid>/task/<tid>/schedstat, which has the time on
/// the CPU, the time waiting for it, both in nanoseconds, and the time slices. Pure.
std::optional<std::chrono::nanoseconds> parse_run_delay(const std::string& schedstat);

/// The run delay of a thread: how long it was ready to run while other threads had its CPU, as the
/// kernel counts it. It distinguishes preemption from a machine that stood still. Another thread
/// takes the samples, so that the thread itself makes no system call.
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
