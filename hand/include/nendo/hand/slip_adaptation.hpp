#pragma once
// Follows a calibrated glove as it slips on the hand. No wearer bends a joint farther than
// when the calibration was made; so if a sensor now goes beyond the end that it reached then, and
// no longer comes to its other end, then the sensor has slipped, by the lesser of the two. A hand
// that only moves less, or in the middle of its range, teaches nothing. Gains and couplings stay.
// The learner's bounds are expectiles of the ends of swings, as those of range_adaptation.hpp.

#include <array>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/range_adaptation.hpp>
#include <nendo/hand/range_capture.hpp>
#include <nendo/hand/sample_interval.hpp>
#include <nendo/hand/swing_finder.hpp>

namespace nendo::hand {

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

  /// Begins with the calibration as it was made for a glove of these counts.
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
  /// Returns the state from which another learner continues.
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
