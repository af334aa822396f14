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
#include <nendo/hand/range_capture.hpp>

namespace nendo::hand {

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
  struct Learner {
    SwingFinder swings;
    SensorCalibration usual;      ///< the joint's usual range, its angles at counts of 0 and 1
    double usual_span = 0.0;      ///< in the default's counts; 0: nothing can be learned
    double low = 0.0, high = 0.0; ///< the bounds, counts
    std::uint32_t bottoms = 0, tops = 0; ///< that were learned from

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

// Follows a calibrated glove as it slips on the hand. No wearer bends a joint farther than
// when the calibration was made; so if a sensor now goes beyond the end that it reached then, and
// no longer comes to its other end, then the sensor has slipped, by the lesser of the two. A hand
// that only moves less, or in the middle of its range, teaches nothing. Gains and couplings stay.
// The learner's bounds are expectiles of the ends of swings, as those of range_adaptation.hpp.
/// The ends that a hand's sensors reached when its calibration was made; counts.
struct CalibratedRange {
  Side side = Side::right;
  CountRanges counts; ///< only the sensors in `present` are followed, and none of gaps
};

/// Returns the smallest slip worth reporting: half a count of a glove that counts to 255.
constexpr double min_slip_counts(CountScale counts) noexcept {
  return 0.5 * counts.most / 255.0;
}

class NENDO_API SlipAdaptation {
public:
  /// Learning changes angles at most this fast.
  static constexpr double max_drift_rad_s = 0.02;
  /// No slip is taken for greater than this part of the sensor's range.
  static constexpr double max_slip = 0.2;

  SlipAdaptation(const Calibration& made, const CalibratedRange& ends, CountScale counts) noexcept;
  /// Continues from `learned`, as after a pause. A sensor whose values in `learned` cannot have
  /// been learned restarts.
  SlipAdaptation(const Calibration& made, const CalibratedRange& ends, CountScale counts,
                 const LearnedRanges& learned) noexcept;

  /// Takes the next sample in time. Samples of the other hand, which is another glove's, teach
  /// nothing. Wait-free, no allocation.
  void push(const GloveSample& sample) noexcept;

  /// Returns the lines as they are moved by now. Finite.
  const Calibration& calibration() const noexcept { return calibration_; }
  Side side() const noexcept { return ends_.side; }
  /// Returns by how many counts each sensor is taken to have slipped, to which the lines drift.
  SensorAngles slips_counts() const noexcept;
  /// Returns the ends of each sensor's swings by now, and how many turns have taught them.
  SensorRanges ranges() const noexcept;
  LearnedRanges learned() const noexcept;

private:
  struct Learner {
    SwingFinder swings;
    double low = 0.0, high = 0.0; ///< ends of swings, counts
    std::uint32_t bottoms = 0, tops = 0;
  };
  double slip_counts(std::size_t slot) const noexcept;

  Calibration made_, calibration_;
  CalibratedRange ends_;
  CountScale counts_;
  SensorMask followed_;
  std::array<Learner, sensor_slots> learners_{};
  SampleInterval interval_;
};

} // namespace nendo::hand
