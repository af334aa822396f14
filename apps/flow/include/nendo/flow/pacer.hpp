#pragma once
// Paces a loop's ticks: the grid of deadlines, the wait between ticks, and the handling of
// overruns. Also the record of a tick's times.

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/event_count.hpp>
#include <nendo/base/result.hpp>
#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/units.hpp>

namespace nendo::flow {

/// Tick k is due at start + k / rate. Each deadline is computed from the start, so that rounding
/// errors do not accumulate where the period is not a whole number of nanoseconds (90 Hz).
class NENDO_API TickGrid {
public:
  static constexpr double min_rate_hz = 1.0;
  static constexpr double max_rate_hz = 10'000.0;

  /// The rate is rounded to 0.001 Hz. Asserts that it is within the limits.
  TickGrid(HostTime start, double rate_hz) noexcept;

  HostTime deadline(std::uint64_t tick) const noexcept;
  /// Returns the first tick with a deadline after `now`.
  std::uint64_t first_after(HostTime now) const noexcept;

private:
  HostTime start_;
  std::uint64_t rate_mhz_; ///< thousandths of a hertz
};

/// Sleeps until an absolute time, and continues sleeping after a signal. This is the only system
/// call of a tick.
NENDO_API void sleep_until(HostTime deadline) noexcept;

/// Adapts how long before a deadline the loop wakes and spins. The margin is the 99.9th percentile
/// of the wake-up latency in the last second, plus 5 microseconds. It is at most 100 microseconds,
/// at most 1/5 of the period, and limited so that spinning would have taken 1/25 of that second.
/// The initial margin is 1/25 of the period. Costs one addition per tick, and 200 per second. Does
/// not allocate.
class NENDO_API SpinMargin {
public:
  static constexpr std::chrono::microseconds most{100};
  static constexpr std::chrono::microseconds reserve{5};
  static constexpr int max_of_period = 25; ///< spinning takes at most 1/25 of the time

  explicit SpinMargin(HostClock::duration period) noexcept;

  HostClock::duration get() const noexcept { return margin_; }
  /// Records the latency of a wake-up.
  void observe(HostClock::duration lateness) noexcept;

private:
  void adapt() noexcept;
  std::chrono::microseconds needed() const noexcept;
  std::chrono::microseconds affordable() const noexcept;

  HostClock::duration period_;
  HostClock::duration cap_;
  HostClock::duration margin_;
  std::uint32_t ticks_per_second_;
  std::uint32_t seen_ = 0;
  /// Counts wake-ups by lateness in whole microseconds; the last entry counts all that are later.
  std::array<std::uint32_t, most.count() + 1> counts_{};
};

/// The reaction to a tick that ended after the next deadline.
enum class OverrunPolicy : std::uint8_t {
  skip,      ///< passed deadlines are missed; the next tick is on the grid
  catch_up,  ///< the newest `max_catch_up` passed deadlines run at once; older ones are missed
  re_anchor, ///< the next tick runs at once, and the grid restarts there; none is missed
  sample,    ///< no grid: each sample starts a tick
};

struct PaceOptions {
  double rate_hz = 90.0; ///< within TickGrid's limits
  OverrunPolicy policy = OverrunPolicy::skip;
  unsigned max_catch_up = 4; ///< at least 1
  /// If set, the pacer wakes before the deadline and spins until it (SpinMargin). DeformLoop spins
  /// only under SCHED_FIFO: under the ordinary scheduler, a spinning thread misses twice as many
  /// deadlines.
  bool spin = false;
  /// With `sample`, the max wait for a sample before a tick, so that the loop detects silence.
  HostClock::duration longest_wait = std::chrono::milliseconds(100);
};

/// Returns "skip", "catch-up" or "catch-up:N" with N from 1 to 1000, "re-anchor", or "sample".
NENDO_API std::string describe_policy(const PaceOptions& options);
/// Parses a text of describe_policy() into policy and max_catch_up. Error: usage, naming the text
/// and the valid ones; then nothing changes.
NENDO_API Result<void> parse_policy(std::string_view text, PaceOptions& options);

/// Loop's thread. It does not allocate or lock, and its only system call is the wait.
class NENDO_API Pacer {
public:
  struct Due {
    std::uint64_t number = 0; ///< the number of the deadline; with `sample`, of the tick
    HostTime scheduled{};     ///< with `sample`: the begin of the wait, or its end at a timeout
    HostTime woke{};          ///< the end of the wait
    std::uint32_t missed = 0; ///< deadlines between the previous tick and this one
    HostClock::duration spun{};
  };

  /// Tick 0 is due at `start`. `event_count` is notified of samples; only OverrunPolicy::sample
  /// needs it.
  Pacer(const PaceOptions& options, HostTime start, EventCount* event_count = nullptr) noexcept;

  /// Waits until the next tick is due. It does not wait if the tick is late.
  Due wait() noexcept;
  /// Must be called at the end of a tick, at `now`; chooses the next tick. Returns true if the tick
  /// overran the next deadline.
  bool end_tick(HostTime now) noexcept;
  /// Returns the number that wait() will return next.
  std::uint64_t next() const noexcept { return next_; }
  HostTime next_deadline() const noexcept { return grid_.deadline(next_ - first_of_grid_); }

private:
  void sleep_and_spin(Due& due) noexcept;

  PaceOptions options_;
  TickGrid grid_;
  EventCount* event_count_;
  std::uint64_t next_ = 0;
  std::uint64_t first_of_grid_ = 0; ///< the tick of the grid's first deadline, after re-anchoring
  std::uint32_t missed_ = 0;
  std::optional<SpinMargin> margin_;
};

/// The times of one tick.
struct alignas(cache_line_bytes) TickRecord {
  std::uint64_t tick = 0; ///< Pacer::Due::number
  HostTime scheduled{};   ///< the deadline; with OverrunPolicy::sample, the newest sample's arrival
  HostTime woke{};
  /// The arrival of the tick's newest sample or, with two hands, the older one of their newest
  /// samples. HostTime{} if there is none.
  HostTime input{};
  // The ends of the tick's stages since its wake-up; at most 4.29 s.
  std::uint32_t drained_ns = 0;   ///< the rings are drained, and the angles computed
  std::uint32_t posed_ns = 0;     ///< joints and fingertips are computed
  std::uint32_t solved_ns = 0;    ///< field and vertices are computed
  std::uint32_t published_ns = 0; ///< the frame is published
  std::uint32_t missed = 0;       ///< deadlines between the previous tick and this one
  std::uint32_t samples = 0;      ///< the number of samples from the rings
  std::uint32_t spun_ns = 0;      ///< the time spun before the deadline

  HostTime published() const noexcept { return woke + std::chrono::nanoseconds(published_ns); }
};
static_assert(sizeof(TickRecord) == cache_line_bytes);

/// A full ring refuses records and counts them; the loop never waits.
using TickRing = SpscRing<TickRecord>;

constexpr std::uint32_t saturated_ns(HostClock::duration time) noexcept {
  using Nanoseconds = std::chrono::nanoseconds;
  return static_cast<std::uint32_t>(
      std::clamp<Nanoseconds::rep>(std::chrono::duration_cast<Nanoseconds>(time).count(), 0,
                                   std::numeric_limits<std::uint32_t>::max()));
}

} // namespace nendo::flow
