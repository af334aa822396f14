#pragma once
// Decides when a loop's ticks run: it keeps the grid of deadlines, handles ticks that take too
// long, and waits between ticks.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/event_count.hpp>
#include <nendo/base/result.hpp>
#include <nendo/flow/spin_margin.hpp>
#include <nendo/flow/tick_grid.hpp>

namespace nendo::flow {

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

} // namespace nendo::flow
