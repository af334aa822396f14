#pragma once
// Chooses how long before a deadline the loop wakes and spins. The time is as long as this
// machine's wake-ups have recently been late, so that nearly every wake-up is over before the
// deadline. It is no longer, because spinning takes processor time.

#include <array>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo::flow {

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

} // namespace nendo::flow
