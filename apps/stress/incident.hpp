#pragma once
// An incident is a tick that was late or missed, with the phase that took the time and the cause.

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

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
/// it: the wake-up, or a stage of the previous tick that went on beyond the deadline.
Incident incident_of(const flow::TickRecord& before, const flow::TickRecord& now,
                     std::chrono::nanoseconds period) noexcept;

/// Returns the cause of an incident. `waited` is how long the thread was ready without running
/// since the incident began, or nothing if that is unknown. A thread that waited for half of the
/// phase was preempted. A stage within twice its usual time did its own work. In all other cases no
/// thread of this system ran, and the cause is outside of it.
Cause cause_of(const Incident& incident, const UsualTimes& usual,
               std::optional<std::chrono::nanoseconds> waited) noexcept;

} // namespace nendo::stress
