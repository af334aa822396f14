#pragma once
// Captures the counts that each sensor reaches while a hand moves freely. If every joint moves from
// end to end, they span its full range of motion.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

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

// Finds the ends of one sensor's swings: the counts at which its joint reverses. A hand at rest has
// none, and an excursion counts once, at any size and duration.
class NENDO_API SwingFinder {
public:
  struct End {
    double counts = 0.0;
    double amplitude = 0.0; ///< size of the swing that ends here, counts
    bool is_top = false;
  };

  /// Takes the next count in time order, and returns the end that it reveals, if any. Ignores
  /// spikes of at most two samples, and movements of less than `min_swing` counts. The first turn
  /// is no end, because the start of its swing is unknown. Wait-free, no allocation.
  std::optional<End> push(std::uint16_t count, double min_swing) noexcept;
  /// Discards the previous counts, as after a pause.
  void reset() noexcept { seen_ = 0; }

private:
  static constexpr std::size_t window = 5; ///< window of the median that removes spikes

  std::optional<double> median(std::uint16_t count) noexcept;

  std::array<std::uint16_t, window> recent_{};
  std::size_t seen_ = 0;            ///< number of counts since the last reset
  double bottom_ = 0.0, top_ = 0.0; ///< the current swing, counts
  bool rises_ = false, falls_ = false;
};

// The time between a glove's samples, for values that drift with each sample.
class SampleInterval {
public:
  /// Limits the drift after a pause, which would be a jump.
  static constexpr double longest_s = 0.1;

  /// Takes the next sample in time order, and returns the seconds since the previous one, at most
  /// `longest_s`; 0 for the first. Wait-free, no allocation.
  double push(const GloveSample& sample) noexcept {
    const HostTime time = sample.time();
    const double interval_s =
        begun_ ? std::clamp(seconds_between(last_, time), 0.0, longest_s) : 0.0;
    last_ = time;
    begun_ = true;
    return interval_s;
  }

private:
  HostTime last_{};
  bool begun_ = false; ///< last_ is valid
};

} // namespace nendo::hand
