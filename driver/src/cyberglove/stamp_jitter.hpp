#pragma once
// How punctually a device takes its time stamps. It is learnt from the gaps between them, so that
// the jitter of a good device costs no record, and a wrong stamp of a punctual one is noticed. It
// is pure (no I/O, clock, log or allocation) and belongs to one thread.

#include <algorithm>
#include <cstdint>

namespace nendo::driver::cyberglove {

/// Returns `gap` in periods, rounded, at least 1. It has 64 bits, as both may be large.
inline std::uint32_t whole_periods(std::uint64_t gap, std::uint64_t period) noexcept {
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, (gap + period / 2) / period));
}

class StampJitter {
public:
  /// Learns from a gap between two stamps, of a glove that is set to `period`. It should be told of
  /// a gap before it is asked about it: stamps that begin to wander then widen what is allowed
  /// rather than be refused.
  void learn(std::uint32_t gap, std::uint32_t period) noexcept;
  /// Returns true if the gap is a whole number of periods, but for what this device's stamps may
  /// wander.
  bool allows(std::uint32_t gap, std::uint32_t period) const noexcept;
  /// Returns true if the stamps wander so much that the period does not count as one that is kept.
  bool hides(std::uint32_t period) const noexcept;
  /// Starts again, because the device has another period.
  void forget() noexcept { *this = {}; }

private:
  std::uint64_t mean() const noexcept; ///< deviation from whole periods, in ticks

  std::uint32_t known_ = 0; ///< deviations that were learnt, while they are few
  std::uint64_t sum_ = 0;   ///< of the last ones, in 1/256 tick
};

} // namespace nendo::driver::cyberglove
