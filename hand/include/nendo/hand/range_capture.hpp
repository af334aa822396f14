#pragma once
// Captures the counts that each sensor reaches while a hand moves freely. If every joint moves from
// end to end, they span its full range of motion.

#include <array>
#include <cstdint>

#include <nendo/base/api.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::hand {

struct NENDO_API CountRanges {
  std::array<double, sensor_slots> low_counts{};
  std::array<double, sensor_slots> high_counts{};
  SensorMask present; ///< the slots that have both values; empty if none is known

  /// Extends the sensor's range to contain `counts`; begins the range if there was none. Wait-free.
  void widen(Sensor sensor, double counts) noexcept;
};

/// Watches samples and keeps the ranges. Wait-free, no allocation.
class NENDO_API RangeCapture {
public:
  RangeCapture() = default;
  explicit RangeCapture(const CountRanges& seen) noexcept : seen_(seen) {}

  /// Takes the next sample in time order. Uses the median of three successive counts, so that a
  /// spike of one sample does not widen a range.
  void push(const GloveSample& sample) noexcept;

  const CountRanges& seen() const noexcept { return seen_; }

private:
  struct Last {
    std::array<double, 2> counts{};
    std::uint8_t known = 0; ///< valid counts
  };
  std::array<Last, sensor_slots> last_{};
  CountRanges seen_;
};

} // namespace nendo::hand
