#pragma once
// How long before a deadline to wake and spin: as late as this machine's wake-ups have been of
// late, so that nearly every one is over before the deadline, and no longer, because spinning
// costs.

#include <array>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo::flow {

/// The margin is the lateness that 99.9 % of the last second's wake-ups did not exceed, and 5
/// microseconds; at most 100 microseconds and a fifth of the period, and what would have spun for a
/// 25th of that second. It begins with a 25th of the period. Costs an addition a tick, and 200 of
/// them a second. No allocation.
class SpinMargin {
public:
  static constexpr std::chrono::microseconds most{100};
  static constexpr std::chrono::microseconds reserve{5};
  static constexpr int most_of_period = 25; ///< a 25th of it is spun on the average, at the most

  explicit SpinMargin(HostClock::duration period) noexcept;

  HostClock::duration get() const noexcept { return margin_; }
  /// How late the kernel woke the thread, against when it was to.
  void observe(HostClock::duration lateness) noexcept;

private:
  void adapt() noexcept;
  std::chrono::microseconds needed() const noexcept;
  std::chrono::microseconds affordable() const noexcept;

  HostClock::duration period_;
  HostClock::duration cap_;
  HostClock::duration margin_;
  std::uint32_t ticks_in_a_second_;
  std::uint32_t seen_ = 0;
  /// Counts wake-ups by lateness in whole microseconds; the last entry counts all that are later.
  std::array<std::uint32_t, most.count() + 1> counts_{};
};

} // namespace nendo::flow
