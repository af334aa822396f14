#pragma once
// A tick that came late, or was missed: which phase took the time, and whose fault that was.

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

/// What a stage usually takes: the time that 99 % of its runs do not exceed. For Phase::wake
/// unused.
using UsualTimes = std::array<std::chrono::nanoseconds, phase_names.size()>;

/// The lateness of `now`, the tick after `before`, and the phase that had most part in it: the wait
/// for the wake-up, or a stage of the tick before that went on beyond the deadline. Pure.
Incident incident_of(const flow::TickRecord& before, const flow::TickRecord& now,
                     std::chrono::nanoseconds period) noexcept;

/// Whose fault it was. `waited`: how long the thread was ready without running since the incident
/// began; nothing if unknown. A thread that waited for half of the phase was preempted; a stage
/// within twice its usual time did its own work; what is left stood still without anybody here
/// running instead. Pure.
Cause cause_of(const Incident& incident, const UsualTimes& usual,
               std::optional<std::chrono::nanoseconds> waited) noexcept;

} // namespace nendo::stress
