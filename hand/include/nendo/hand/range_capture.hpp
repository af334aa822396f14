#pragma once
// What each sensor reached while a hand moved freely: with every joint moved from end to end, the
// counts of a whole range of motion.

#include <array>
#include <cstdint>

#include <nendo/driver/sample.hpp>

namespace nendo::hand {

struct CountRanges {
  std::array<double, sensor_slots> low_counts{};
  std::array<double, sensor_slots> high_counts{};
  SensorMask present; ///< of which slots the two tell; none: nothing is known
};

/// Wait-free, no allocation. One thread.
class RangeCapture {
public:
  RangeCapture() = default;
  /// Goes on from what was seen before.
  explicit RangeCapture(const CountRanges& seen) noexcept : seen_(seen) {}

  /// The next sample in time. A count counts once it is the middle one of three in a row by size,
  /// so that a single sample that jumps does not widen a range.
  void push(const GloveSample& sample) noexcept;

  const CountRanges& seen() const noexcept { return seen_; }

private:
  struct Last {
    std::array<double, 2> counts{};
    std::uint8_t known = 0; ///< how many
  };
  std::array<Last, sensor_slots> last_{};
  CountRanges seen_;
};

} // namespace nendo::hand
