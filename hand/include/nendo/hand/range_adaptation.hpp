#pragma once
// Calibration by use, for visitors who will not calibrate: each sensor's range is learned from how
// the hand moves, and spread over its joint's usual range of motion. It begins as the default
// calibration and changes so slowly that nobody sees the hand drift.
//
// What teaches is a joint's turn: the end of a swing, from which it comes back. So a hand at rest
// teaches nothing, however long, and one excursion counts once, however far and long: a glove that
// is put on or taken off, a sensor that sticks, does little. The two bounds are expectiles of those
// ends (W. K. Newey, J. L. Powell, "Asymmetric Least Squares Estimation and Testing", Econometrica
// 55, 1987): an end beyond the bound draws it much, an end short of it a little, so that the bounds
// come in again for a hand that moves less.

#include <array>
#include <cstdint>
#include <optional>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>

namespace nendo::hand {

/// What was learned of a sensor.
struct SensorRange {
  double low_counts = 0.0;  ///< where its joint is at the lower end of its usual range
  double high_counts = 0.0; ///< where it is at the upper end
  std::uint64_t turns = 0;  ///< how many turns of the joint taught them; 0: the default's counts
};
using SensorRanges = std::array<SensorRange, sensor_slots>;

/// All that a learner needs to go on where another one stopped.
struct LearnedRanges {
  struct Sensor {
    double low_counts = 0.0, high_counts = 0.0; ///< as SensorRange has them
    std::uint32_t bottoms = 0, tops = 0;        ///< turns that taught the one and the other
    SensorCalibration line; ///< on its way to them; a gain of 0: nothing can be learned
  };
  Side side = Side::right; ///< of the hand that they are of
  std::array<Sensor, sensor_slots> sensors{};
};

class RangeAdaptation {
public:
  /// No count's angle changes faster than that through learning.
  static constexpr double most_drift_rad_s = 0.1;
  /// Less than this part of the usual range, in the default's counts, is no swing.
  static constexpr double least_swing = 0.15;
  /// What one swing's end moves a bound by, at most, as a part of that range: of the first, and
  /// once many have come.
  static constexpr double most_first_step = 0.25;
  static constexpr double most_step = 0.05;
  /// The bounds never come nearer to each other than this part of that range.
  static constexpr double least_span = 0.35;

  /// Of a glove whose counts mean this. Nothing is ever learned with `most` = 0.
  explicit RangeAdaptation(CountScale counts = {}) noexcept;
  /// Goes on, as after a pause in which no sensor sent anything. A sensor of which `learned` tells
  /// what cannot have been learned begins anew.
  RangeAdaptation(CountScale counts, const LearnedRanges& learned) noexcept;

  /// The next sample, in time. A count that is gone again within two samples is not seen. A sample
  /// of the other hand, another glove's, begins anew, from the default. Wait-free, no allocation.
  void push(const GloveSample& sample) noexcept;

  /// Lines only, without couplings: default_calibration() at first. Finite.
  const Calibration& calibration() const noexcept { return calibration_; }
  /// What the lines are on their way to. Zeros for slots that no glove fills.
  SensorRanges ranges() const noexcept;
  /// For whoever goes on. Null before the first sample: nothing is known, not even which hand's.
  std::optional<LearnedRanges> learned() const noexcept;

private:
  static constexpr std::size_t window = 5; ///< of the median that takes out spikes

  /// One sensor.
  struct Learner {
    std::array<std::uint16_t, window> recent{};
    std::size_t seen = 0;           ///< of `recent`, since it was absent
    SensorCalibration usual;        ///< the joint's usual range, its angles at counts of 0 and 1
    double usual_span = 0.0;        ///< in the default's counts; 0: nothing can be learned
    double low = 0.0, high = 0.0;   ///< the bounds, counts
    double bottom = 0.0, top = 0.0; ///< the swing under way, counts
    bool rises = false, falls = false;
    std::uint32_t bottoms = 0, tops = 0; ///< that were learned from

    void follow(double count) noexcept;
    void learn_top(double amplitude) noexcept;
    void learn_bottom(double amplitude) noexcept;
    bool median(std::uint16_t count, double& result) noexcept;
    bool can_have_learned(const LearnedRanges::Sensor& sensor, CountScale counts) const noexcept;
  };
  /// Turns the sensor's line towards its bounds.
  void drift(std::size_t slot, double interval_s) noexcept;

  CountScale counts_;
  Calibration calibration_;
  std::array<Learner, sensor_slots> learners_{};
  HostTime last_time_{};
  std::optional<Side> side_; ///< of the samples so far
  bool begun_ = false;       ///< last_time_ is one
};

} // namespace nendo::hand
