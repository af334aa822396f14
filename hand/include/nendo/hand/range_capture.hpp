#pragma once
// Captures the counts that each sensor reaches while a hand moves freely. If every joint is moved
// from end to end, these are the counts of a whole range of motion.

#include <array>
#include <cstdint>

#include <nendo/driver/sample.hpp>

namespace nendo::hand {

struct NENDO_API CountRanges {
  std::array<double, sensor_slots> low_counts{};
  std::array<double, sensor_slots> high_counts{};
  SensorMask present; ///< the slots for which the two are set; none: nothing is known

  /// Makes the sensor's range contain these counts; sets it to them if there was none. Wait-free.
  void widen(Sensor sensor, double counts) noexcept;
};

/// Watches samples and keeps the ranges. Wait-free, no allocation.
class NENDO_API RangeCapture {
public:
  RangeCapture() = default;
  /// Continues from the ranges that were seen before.
  explicit RangeCapture(const CountRanges& seen) noexcept : seen_(seen) {}

  /// Takes the next sample in time. Of three counts in a row only the one in the middle by size is
  /// used, so that a single sample that jumps does not widen a range.
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
