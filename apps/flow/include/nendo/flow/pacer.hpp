#pragma once
// Decides when a loop's ticks run: it keeps the grid of deadlines, handles ticks that take too
// long, and waits between ticks.

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

/// Tick k is due at start + k / rate. That is computed from the start each time, so that rounding
/// errors never add up to drift, also where the period is no whole number of nanoseconds (90 Hz).
class NENDO_API TickGrid {
public:
  static constexpr double min_rate_hz = 1.0;
  static constexpr double max_rate_hz = 10'000.0;

  /// The rate is kept to a thousandth of a hertz. Asserts that it is within the limits.
  TickGrid(HostTime start, double rate_hz) noexcept;

  HostTime deadline(std::uint64_t tick) const noexcept;
  /// Returns the first tick that is due later than `now`.
  std::uint64_t first_after(HostTime now) const noexcept;

private:
  HostTime start_;
  std::uint64_t rate_mhz_; ///< thousandths of a hertz
};

/// Sleeps until an absolute time, and continues sleeping after a signal. This is the only system
/// call of a tick.
NENDO_API void sleep_until(HostTime deadline) noexcept;

/// Chooses how long before a deadline the loop wakes and spins, which takes processor time.
/// The margin is the lateness that 99.9 % of the last second's wake-ups did not exceed, plus 5
/// microseconds. It is at most 100 microseconds, at most a fifth of the period, and no more than
/// would have spun for a 25th of that second. It begins with a 25th of the period. It costs an
/// addition a tick, and 200 additions a second. It does not allocate.
class NENDO_API SpinMargin {
public:
  static constexpr std::chrono::microseconds most{100};
  static constexpr std::chrono::microseconds reserve{5};
  static constexpr int max_of_period = 25; ///< on average, at most a 25th of it is spun

  explicit SpinMargin(HostClock::duration period) noexcept;

  HostClock::duration get() const noexcept { return margin_; }
  /// Records how late the kernel woke the thread.
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
  skip,      ///< deadlines that passed are missed; the next tick is on the grid again
  catch_up,  ///< they are run at once, the newest `max_catch_up` of them; older ones are missed
  re_anchor, ///< the next tick runs at once, and the grid restarts there; none is missed
  sample,    ///< no grid: a tick runs when a sample comes
};

struct PaceOptions {
  double rate_hz = 90.0; ///< within TickGrid's limits
  OverrunPolicy policy = OverrunPolicy::skip;
  unsigned max_catch_up = 4; ///< at least 1
  /// If set, the pacer wakes before the deadline and spins until it (SpinMargin). DeformLoop does
  /// so only under SCHED_FIFO: under the ordinary scheduler, a thread that spins misses twice as
  /// many deadlines.
  bool spin = false;
  /// With `sample`, a tick runs after this time without a sample, so that silence is noticed.
  HostClock::duration longest_wait = std::chrono::milliseconds(100);
};

/// Returns "skip", "catch-up" or "catch-up:N" with N from 1 to 1000, "re-anchor", or "sample".
NENDO_API std::string describe_policy(const PaceOptions& options);
/// Sets policy and max_catch_up by such a text. Error: usage, naming the text and these; then
/// nothing changes.
NENDO_API Result<void> parse_policy(std::string_view text, PaceOptions& options);

/// Loop's thread. It does not allocate or lock, and its only system call is the wait.
class NENDO_API Pacer {
public:
  struct Due {
    std::uint64_t number = 0; ///< the number of the deadline; with `sample`, of the tick
    HostTime scheduled{};     ///< with `sample`: when the wait began or, in vain, ended
    HostTime woke{};          ///< when the wait was over
    std::uint32_t missed = 0; ///< deadlines between the tick before and this one
    HostClock::duration spun{};
  };

  /// Tick 0 is due at `start`. `event_count` is notified of samples; only OverrunPolicy::sample
  /// needs it.
  Pacer(const PaceOptions& options, HostTime start, EventCount* event_count = nullptr) noexcept;

  /// Waits until the next tick is due. It does not wait if the tick is late.
  Due wait() noexcept;
  /// Must be called when the tick ended, at `now`; decides which tick comes next. Returns true if
  /// the tick overran the next deadline.
  bool end_tick(HostTime now) noexcept;
  /// Returns the number that wait() gives next. Deadlines with lower numbers are past.
  std::uint64_t next() const noexcept { return next_; }
  HostTime next_deadline() const noexcept { return grid_.deadline(next_ - first_of_grid_); }

private:
  void sleep_and_spin(Due& due) noexcept;

  PaceOptions options_;
  TickGrid grid_;
  EventCount* event_count_;
  std::uint64_t next_ = 0;
  std::uint64_t first_of_grid_ = 0; ///< which tick the grid's first deadline is, after re-anchoring
  std::uint32_t missed_ = 0;
  std::optional<SpinMargin> margin_;
};

/// The times of one tick.
struct alignas(cache_line_bytes) TickRecord {
  std::uint64_t tick = 0; ///< Pacer::Due::number
  HostTime scheduled{};   ///< the deadline; paced by samples, when the newest of them arrived
  HostTime woke{};
  /// When the sample arrived that the tick shows. That is the newest sample of a hand, and the
  /// older one of two hands'. It is HostTime{} if none came.
  HostTime input{};
  // The ends of the tick's stages, counted from its wake-up; at most 4.29 s.
  std::uint32_t drained_ns = 0;   ///< the rings are empty, the angles known
  std::uint32_t posed_ns = 0;     ///< the hands' joints and fingertips
  std::uint32_t solved_ns = 0;    ///< the field and the vertices
  std::uint32_t published_ns = 0; ///< the frame is out
  std::uint32_t missed = 0;       ///< deadlines between the tick before and this one
  std::uint32_t samples = 0;      ///< taken from the rings
  std::uint32_t spun_ns = 0;      ///< the time spun before the deadline

  HostTime published() const noexcept { return woke + std::chrono::nanoseconds(published_ns); }
};
static_assert(sizeof(TickRecord) == cache_line_bytes);

/// A full ring refuses records and counts them, so that the loop never waits.
using TickRing = SpscRing<TickRecord>;

constexpr std::uint32_t saturated_ns(HostClock::duration time) noexcept {
  using Nanoseconds = std::chrono::nanoseconds;
  return static_cast<std::uint32_t>(
      std::clamp<Nanoseconds::rep>(std::chrono::duration_cast<Nanoseconds>(time).count(), 0,
                                   std::numeric_limits<std::uint32_t>::max()));
}

} // namespace nendo::flow
