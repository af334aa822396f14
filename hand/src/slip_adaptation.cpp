#include <nendo/hand/slip_adaptation.hpp>

#include <algorithm>
#include <cmath>

namespace nendo::hand {
namespace {

// How far the end of a swing draws a bound: outwards half of the way, but never by more than a part
// of the range, lest a tug at the glove pass for a slip; inwards so little that it takes some two
// hundred full swings. Chosen with synthetic wearers, seeds 1 to 20: five times as fast inwards,
// slips are followed less far; half as fast, wearers whose gloves do not slip are worse off.
constexpr double slip_out_share = 0.5;
constexpr double slip_in_share = 0.004;
constexpr double slip_max_step = 0.02;

// A sensor that moved less when the calibration was made is not one whose ends are known.
constexpr double min_followed_span = 0.1; ///< fraction of the glove's counts

} // namespace

SlipAdaptation::SlipAdaptation(const Calibration& made, const CalibratedRange& ends,
                               CountScale counts) noexcept
    : made_(made), calibration_(made), ends_(ends), counts_(counts) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    const double low = ends.counts.low_counts[slot], high = ends.counts.high_counts[slot];
    // How far gaps between fingers go depends on how the fingers are bent, so they show no slip.
    // Written so that a NaN is not followed; ends may come from a file.
    if (ends.counts.present.has(sensor) && !is_gap(sensor) && low >= 0.0 &&
        high <= counts.max_count && high - low >= min_followed_span * counts.max_count &&
        made.sensors[slot].gain_rad_per_count != 0.0)
      followed_.add(sensor);
    learners_[slot].low = low;
    learners_[slot].high = high;
  }
}

SlipAdaptation::SlipAdaptation(const Calibration& made, const CalibratedRange& ends,
                               CountScale counts, const LearnedRanges& learned) noexcept
    : SlipAdaptation(made, ends, counts) {
  if (learned.side != ends.side) return;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const LearnedRanges::Sensor& sensor = learned.sensors[slot];
    const double span = ends.counts.high_counts[slot] - ends.counts.low_counts[slot];
    const double slipped = sensor.line.offset_counts - made.sensors[slot].offset_counts;
    const bool can_be = followed_.has(static_cast<Sensor>(slot)) && sensor.low_counts >= 0.0 &&
                        sensor.high_counts <= counts.max_count &&
                        sensor.low_counts <= sensor.high_counts &&
                        std::abs(slipped) <= max_slip * span;
    if (!can_be) continue;
    learners_[slot].restore(sensor);
    calibration_.sensors[slot].offset_counts = sensor.line.offset_counts;
  }
}

double SlipAdaptation::slip_counts(std::size_t slot) const noexcept {
  if (!followed_.has(static_cast<Sensor>(slot))) return 0.0;
  const double low = ends_.counts.low_counts[slot], high = ends_.counts.high_counts[slot];
  const double of_low = learners_[slot].low - low, of_high = learners_[slot].high - high;
  if (of_low * of_high <= 0.0) return 0.0; // it moves less, or more, or as it did
  const double most = max_slip * (high - low);
  return std::copysign(std::min({std::abs(of_low), std::abs(of_high), most}), of_high);
}

void SlipAdaptation::push(const GloveSample& sample) noexcept {
  const bool own = sample.side == ends_.side;
  const double interval_s = interval_.push(sample);
  for (const Sensor sensor : followed_) {
    const std::size_t slot = index_of(sensor);
    SwingEnds& learner = learners_[slot];
    if (!own || !sample.present.has(sensor)) {
      learner.swings.reset();
      continue;
    }
    const double span = ends_.counts.high_counts[slot] - ends_.counts.low_counts[slot];
    const std::uint16_t count = std::min(sample.raw[slot].value, counts_.max_count);
    if (const auto end = learner.swings.push(count, RangeAdaptation::min_swing * span)) {
      double& bound = end->is_top ? learner.high : learner.low;
      const double part = std::min(end->amplitude / span, 1.0);
      const double off = end->counts - bound, share = (end->is_top == (off > 0.0))
                                                          ? slip_out_share
                                                          : slip_in_share * part * part;
      bound += std::clamp(share * off, -slip_max_step * span, slip_max_step * span);
      ++(end->is_top ? learner.tops : learner.bottoms);
    }
    auto& [gain_rad, offset] = calibration_.sensors[slot];
    const double most = max_drift_rad_s * interval_s / std::abs(gain_rad);
    const double left = made_.sensors[slot].offset_counts + slip_counts(slot) - offset;
    offset += std::clamp(left, -most, most);
  }
}

SensorAngles SlipAdaptation::slips_counts() const noexcept {
  SensorAngles slips{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    slips[slot] = slip_counts(slot);
  return slips;
}

SensorRanges SlipAdaptation::ranges() const noexcept {
  SensorRanges ranges;
  for (const Sensor sensor : followed_)
    ranges[index_of(sensor)] = learners_[index_of(sensor)].range();
  return ranges;
}

LearnedRanges SlipAdaptation::learned() const noexcept {
  LearnedRanges learned{ends_.side, {}};
  for (const Sensor sensor : followed_)
    learned.sensors[index_of(sensor)] = learners_[index_of(sensor)].learned(calibration_[sensor]);
  return learned;
}

} // namespace nendo::hand
