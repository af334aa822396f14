#pragma once
// Calibration during use, for visitors who do not calibrate: each sensor's range is learned from
// the hand's movements and mapped to its joint's usual range of motion. It begins as the default
// calibration and changes so slowly that the drift is not visible.
//
// The learner uses a joint's turns: a turn is the end of a swing, where the joint reverses. A hand
// at rest therefore changes nothing. An excursion counts once, at any size and duration, so that
// putting a glove on or off, or a sensor that sticks, has little effect. The two bounds are
// expectiles of those ends (W. K. Newey, J. L. Powell, "Asymmetric Least Squares Estimation and
// Testing", Econometrica 55, 1987): an end beyond the bound moves it much, an end short of it moves
// it a little, so that the bounds contract for a hand that moves less.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/swing_finder.hpp>

namespace nendo::hand {

struct SensorRange {
  double low_counts = 0.0;  ///< the count at the lower end of the joint's usual range
  double high_counts = 0.0; ///< the count at the upper end
  std::uint64_t turns = 0;  ///< number of turns used; 0: the counts are the default's
};
using SensorRanges = std::array<SensorRange, sensor_slots>;

/// The state of a learner, from which another one can continue.
struct LearnedRanges {
  struct Sensor {
    double low_counts = 0.0, high_counts = 0.0; ///< as in SensorRange
    std::uint32_t bottoms = 0, tops = 0;        ///< turns used for low and high
    SensorCalibration line;                     ///< drifts towards this range; gain 0: cannot learn
  };
  Side side = Side::right; ///< the hand that was learned
  std::array<Sensor, sensor_slots> sensors{};
};

/// Returns the final line for `range`; its gain is 0 if the range was not learned.
NENDO_API SensorCalibration line_of(std::size_t slot, const SensorRange& range) noexcept;
/// Returns a state with the final lines of `ranges`, from which a learner can continue.
NENDO_API LearnedRanges learned_from(const SensorRanges& ranges, Side side) noexcept;

/// The time between a glove's samples, for values that drift with each sample.
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

/// The ends of one sensor's swings, in counts, and the number of ends used.
struct SwingEnds {
  SwingFinder swings;
  double low = 0.0, high = 0.0;
  std::uint32_t bottoms = 0, tops = 0;

  SensorRange range() const noexcept { return {low, high, std::uint64_t{bottoms} + tops}; }
  LearnedRanges::Sensor learned(const SensorCalibration& line) const noexcept {
    return {low, high, bottoms, tops, line};
  }
  void restore(const LearnedRanges::Sensor& sensor) noexcept {
    low = sensor.low_counts;
    high = sensor.high_counts;
    bottoms = sensor.bottoms;
    tops = sensor.tops;
  }
};

class NENDO_API RangeAdaptation {
public:
  /// Learning changes the angle of a count at most this fast.
  static constexpr double max_drift_rad_s = 0.1;
  /// The minimum size of a swing, as a fraction of the usual range in the default's counts.
  static constexpr double min_swing = 0.15;
  /// The maximum step of a bound per swing, as a fraction of that range: for the first swing, and
  /// after many.
  static constexpr double max_first_step = 0.25;
  static constexpr double max_step = 0.05;
  /// The minimum distance of the bounds, as a fraction of that range.
  static constexpr double min_span = 0.35;

  /// Begins with the default calibration for a glove of this scale. With `max_count` = 0 nothing is
  /// ever learned.
  explicit RangeAdaptation(CountScale counts = {}) noexcept;
  /// Continues from `learned`, as after a pause without samples. Sensors with impossible values in
  /// `learned` restart.
  RangeAdaptation(CountScale counts, const LearnedRanges& learned) noexcept;

  /// Takes the next sample in time order. Ignores spikes of at most two samples. A sample of the
  /// other hand, thus of another glove, restarts from the default. Wait-free, no allocation.
  void push(const GloveSample& sample) noexcept;

  /// Returns the current lines, without couplings; at first, those of default_calibration().
  /// Finite.
  const Calibration& calibration() const noexcept { return calibration_; }
  /// Returns the ranges towards which the lines drift; zeros for slots that no glove has.
  SensorRanges ranges() const noexcept;
  /// Returns the hand whose ranges are learned; nullopt before the first sample.
  std::optional<Side> side() const noexcept { return side_; }
  /// Returns the state from which another learner can continue. It is nullopt before the first
  /// sample, because the side is unknown.
  std::optional<LearnedRanges> learned() const noexcept;

private:
  struct Learner : SwingEnds {
    SensorCalibration usual; ///< line through the joint's usual range at counts 0 and 1
    double usual_span = 0.0; ///< in the default's counts; 0: nothing can be learned

    void learn(const SwingFinder::End& end) noexcept;
    bool can_have_learned(const LearnedRanges::Sensor& sensor, CountScale counts) const noexcept;
  };
  void drift(std::size_t slot, double interval_s) noexcept;

  CountScale counts_;
  Calibration calibration_;
  std::array<Learner, sensor_slots> learners_{};
  SampleInterval interval_;
  std::optional<Side> side_; ///< side of the samples so far
};

} // namespace nendo::hand
