#pragma once
// Captures the counts that each sensor reaches while a hand moves freely. If every joint is moved
// from end to end, these are the counts of a whole range of motion.

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
  SensorMask present; ///< the slots for which the two are set; none: nothing is known

  /// Makes the sensor's range contain these counts; sets it to them if there was none. Wait-free.
  void widen(Sensor sensor, double counts) noexcept;
};

/// Watches samples and keeps the ranges. Wait-free, no allocation.
class NENDO_API RangeCapture {
public:
  RangeCapture() = default;
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

// Finds the ends of the swings of one sensor: the counts from which its joint comes back. A hand at
// rest has none, however long it rests, and an excursion counts once, however far and long it is.
class NENDO_API SwingFinder {
public:
  struct End {
    double counts = 0.0;
    double amplitude = 0.0; ///< size of the swing that ends here, counts
    bool is_top = false;
  };

  /// Takes the next count in time, and returns the end that it shows, if any. A count that is gone
  /// again within two samples is not seen. A movement over less than `min_swing` counts is no
  /// swing. Where the first count lies in its swing is not known, so that the first turn is no end.
  /// Wait-free, no allocation.
  std::optional<End> push(std::uint16_t count, double min_swing) noexcept;
  /// Forgets what came before, as after a pause.
  void reset() noexcept { seen_ = 0; }

private:
  static constexpr std::size_t window = 5; ///< window of the median that removes spikes

  std::optional<double> median(std::uint16_t count) noexcept;

  std::array<std::uint16_t, window> recent_{};
  std::size_t seen_ = 0;            ///< number of counts since the last reset
  double bottom_ = 0.0, top_ = 0.0; ///< the swing under way, counts
  bool rises_ = false, falls_ = false;
};

// The time between a glove's samples, for what moves a little with each of them.
class SampleInterval {
public:
  /// A pause is no time in which anything moves: it would jump.
  static constexpr double longest_s = 0.1;

  /// Takes the next sample in time, and returns the seconds since the previous one, at most
  /// `longest_s`; 0 of the first. Wait-free, no allocation.
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
  bool begun_ = false; ///< last_ is one
};

} // namespace nendo::hand
