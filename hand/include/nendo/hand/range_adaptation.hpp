#pragma once
// Calibration by use, for visitors who will not calibrate: each sensor's range is learned from how
// the hand moves, and spread over its joint's usual range of motion. It begins as the default
// calibration and changes so slowly that the drift is not visible.
//
// The learner learns from a joint's turns: a turn is the end of a swing, from which the joint comes
// back. So a hand at rest teaches nothing, however long it rests. One excursion counts once,
// however far and long it is, so that putting a glove on or off, or a sensor that sticks, has
// little effect. The two bounds are expectiles of those ends (W. K. Newey, J. L. Powell,
// "Asymmetric Least Squares Estimation and Testing", Econometrica 55, 1987): an end beyond the
// bound moves it much, an end short of it moves it a little, so that the bounds come closer again
// for a hand that moves less.

#include <array>
#include <cstdint>
#include <optional>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/sample_interval.hpp>
#include <nendo/hand/swing_finder.hpp>

namespace nendo::hand {

/// What was learned about a sensor.
struct SensorRange {
  double low_counts = 0.0;  ///< where its joint is at the lower end of its usual range
  double high_counts = 0.0; ///< where it is at the upper end
  std::uint64_t turns = 0;  ///< turns of the joint that taught them; 0: they are the default's
};
using SensorRanges = std::array<SensorRange, sensor_slots>;

/// The state of a learner, from which another one can continue.
struct LearnedRanges {
  struct Sensor {
    double low_counts = 0.0, high_counts = 0.0; ///< as in SensorRange
    std::uint32_t bottoms = 0, tops = 0;        ///< turns that taught low and high
    SensorCalibration line; ///< drifts towards them; gain 0: nothing can be learned
  };
  Side side = Side::right; ///< the hand from which they were learned
  std::array<Sensor, sensor_slots> sensors{};
};

/// Returns the line that such a range leads to in the end; a gain of 0 for one that was not
/// learned.
NENDO_API SensorCalibration line_of(std::size_t slot, const SensorRange& range) noexcept;
/// Returns a state from which another learner continues: its lines are those that the ranges lead
/// to.
NENDO_API LearnedRanges learned_from(const SensorRanges& ranges, Side side) noexcept;

class NENDO_API RangeAdaptation {
public:
  /// Learning changes the angle of a count at most this fast.
  static constexpr double max_drift_rad_s = 0.1;
  /// A movement over less than this part of the usual range, in the default's counts, is no swing.
  static constexpr double min_swing = 0.15;
  /// How far the end of one swing moves a bound at most, as a part of that range: for the first
  /// swing, and once there have been many.
  static constexpr double max_first_step = 0.25;
  static constexpr double max_step = 0.05;
  /// The bounds never come nearer to each other than this part of that range.
  static constexpr double min_span = 0.35;

  /// Begins with the default calibration for a glove of this scale. With `most` = 0 nothing is ever
  /// learned.
  explicit RangeAdaptation(CountScale counts = {}) noexcept;
  /// Continues from `learned`, as after a pause in which no sensor sent anything. A sensor whose
  /// values in `learned` cannot have been learned restarts.
  RangeAdaptation(CountScale counts, const LearnedRanges& learned) noexcept;

  /// Takes the next sample in time. Ignores a count that is gone again within two samples. A sample
  /// of the other hand, which is another glove's, restarts from the default. Wait-free, no
  /// allocation.
  void push(const GloveSample& sample) noexcept;

  /// Returns the present lines, without couplings; they are those of default_calibration() at
  /// first. Finite.
  const Calibration& calibration() const noexcept { return calibration_; }
  /// Returns the ranges towards which the lines drift; zeros for slots that no glove fills.
  SensorRanges ranges() const noexcept;
  /// Returns the hand whose ranges are learned; nullopt before the first sample.
  std::optional<Side> side() const noexcept { return side_; }
  /// Returns the state from which another learner can continue. It is nullopt before the first
  /// sample, because then not even the hand is known.
  std::optional<LearnedRanges> learned() const noexcept;

private:
  /// What is learned about one sensor.
  struct Learner {
    SwingFinder swings;
    SensorCalibration usual;      ///< the joint's usual range, its angles at counts of 0 and 1
    double usual_span = 0.0;      ///< in the default's counts; 0: nothing can be learned
    double low = 0.0, high = 0.0; ///< the bounds, counts
    std::uint32_t bottoms = 0, tops = 0; ///< that were learned from

    void learn(const SwingFinder::End& end) noexcept;
    bool can_have_learned(const LearnedRanges::Sensor& sensor, CountScale counts) const noexcept;
  };
  /// Turns the sensor's line towards its bounds.
  void drift(std::size_t slot, double interval_s) noexcept;

  CountScale counts_;
  Calibration calibration_;
  std::array<Learner, sensor_slots> learners_{};
  SampleInterval interval_;
  std::optional<Side> side_; ///< side of the samples so far
};

} // namespace nendo::hand
