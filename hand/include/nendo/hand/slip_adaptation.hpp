#pragma once
// Follows how far a calibrated glove slips on the hand while it is used.

#include <array>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/range_adaptation.hpp>
#include <nendo/hand/range_capture.hpp>

namespace nendo::hand {

/// The ends that a hand's sensors reached when its calibration was made; counts.
struct CalibratedRange {
  Side side = Side::right;
  CountRanges counts; ///< only sensors in `present` are tracked, without gap sensors
};

/// Returns the smallest slip worth reporting: half a count of a glove that counts to 255.
constexpr double min_slip_counts(CountScale counts) noexcept {
  return 0.5 * counts.max_count / 255.0;
}

/// Tracks the slip of a calibrated glove on the hand. It assumes that no joint bends farther than
/// during the calibration: if a sensor now exceeds one of its ends from then and no longer reaches
/// the other, it has slipped, by the lesser of the two differences. A hand that only moves less, or
/// in the middle of its range, changes nothing. Gains and couplings stay. The bounds are expectiles
/// of the ends of swings, as in RangeAdaptation.
class NENDO_API SlipAdaptation {
public:
  /// Learning changes angles at most this fast.
  static constexpr double max_drift_rad_s = 0.02;
  /// The maximum slip, as a fraction of the sensor's range.
  static constexpr double max_slip = 0.2;

  SlipAdaptation(const Calibration& made, const CalibratedRange& ends, CountScale counts) noexcept;
  /// Continues from `learned`, as after a pause. Sensors with impossible values in `learned`
  /// restart.
  SlipAdaptation(const Calibration& made, const CalibratedRange& ends, CountScale counts,
                 const LearnedRanges& learned) noexcept;

  /// Takes the next sample in time order. Samples of the other hand, thus of another glove, are
  /// ignored. Wait-free, no allocation.
  void push(const GloveSample& sample) noexcept;

  /// Returns the current lines. Finite.
  const Calibration& calibration() const noexcept { return calibration_; }
  Side side() const noexcept { return ends_.side; }
  /// Returns the estimated slip of each sensor, in counts, to which the lines drift.
  SensorAngles slips_counts() const noexcept;
  /// Returns the current ends of each sensor's swings, and the number of turns used.
  SensorRanges ranges() const noexcept;
  LearnedRanges learned() const noexcept;

private:
  double slip_counts(std::size_t slot) const noexcept;

  Calibration made_, calibration_;
  CalibratedRange ends_;
  CountScale counts_;
  SensorMask followed_;
  std::array<SwingEnds, sensor_slots> learners_{};
  SampleInterval interval_;
};

} // namespace nendo::hand
