#include <nendo/hand/range_adaptation.hpp>

#include <algorithm>
#include <cmath>

namespace nendo::hand {
namespace {

// How far an end of a swing draws a bound: outwards most of the way at once; inwards a part, which
// is the less the more has been seen. The ratio of the last two sets which expectile is kept, here
// that of 0.993; the last one alone, how soon a smaller hand takes over from one that has been
// there for long: half-way in 140 full swings. Chosen with synthetic wearers, seeds 1 to 50.
constexpr double out_share = 0.7;
constexpr double first_in_share = 0.6;
constexpr double last_in_share = 0.005;
/// After so many ends of swings the first share, and the first step, have come down by a half.
constexpr double half_after = 4.0;

double decline(std::uint32_t ends, double first, double last) noexcept {
  return last + (first - last) / (1.0 + ends / half_after);
}

/// Returns the bound as the end of a swing moves it. `outwards` is -1 or 1; amplitude is of
/// the swing.
double drawn(double bound, double end, double outwards, double amplitude, double span,
             double usual_span, std::uint32_t ends) noexcept {
  const double beyond = outwards * (end - bound);
  if (beyond > 0.0) {
    const double most =
        usual_span * decline(ends, RangeAdaptation::max_first_step, RangeAdaptation::max_step);
    return bound + outwards * std::min(out_share * beyond, most);
  }
  // A swing in the middle of the range says little about its ends.
  const double part = std::min(amplitude / span, 1.0);
  return bound + outwards * decline(ends, first_in_share, last_in_share) * part * part * beyond;
}

} // namespace

SensorCalibration line_of(std::size_t slot, const SensorRange& range) noexcept {
  const SensorCalibration usual = default_calibration({1, true}).sensors[slot];
  const double span = range.high_counts - range.low_counts;
  if (range.turns == 0 || usual.gain_rad_per_count == 0.0 || !(span > 0.0)) return {};
  const double gain_rad = usual.gain_rad_per_count / span;
  return {gain_rad, range.low_counts - usual.angle_rad(RawCount{0}) / gain_rad};
}

LearnedRanges learned_from(const SensorRanges& ranges, Side side) noexcept {
  LearnedRanges learned{side, {}};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto turns =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(ranges[slot].turns, 1u << 20));
    learned.sensors[slot] = {ranges[slot].low_counts, ranges[slot].high_counts, turns - turns / 2,
                             turns / 2, line_of(slot, ranges[slot])};
  }
  return learned;
}

RangeAdaptation::RangeAdaptation(CountScale counts) noexcept
    : counts_(counts), calibration_(default_calibration(counts)) {
  const Calibration usual_ranges = default_calibration({1, true});
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto [gain_rad, offset] = calibration_.sensors[slot];
    if (gain_rad == 0.0) continue;
    Learner& learner = learners_[slot];
    learner.usual = usual_ranges.sensors[slot];
    learner.low = offset + learner.usual.angle_rad(RawCount{0}) / gain_rad;
    learner.high = offset + learner.usual.angle_rad(RawCount{1}) / gain_rad;
    learner.usual_span = learner.high - learner.low;
  }
}

RangeAdaptation::RangeAdaptation(CountScale counts, const LearnedRanges& learned) noexcept
    : RangeAdaptation(counts) {
  side_ = learned.side;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const LearnedRanges::Sensor& sensor = learned.sensors[slot];
    Learner& learner = learners_[slot];
    if (!learner.can_have_learned(sensor, counts)) continue;
    learner.restore(sensor);
    calibration_.sensors[slot] = sensor.line;
  }
}

/// Numbers may come from a file.
bool RangeAdaptation::Learner::can_have_learned(const LearnedRanges::Sensor& sensor,
                                                CountScale counts) const noexcept {
  constexpr double rounding = 1e-9;
  constexpr double min_gain_rad = 1e-9; // a line on its way to any usual range lies far within
  constexpr double max_gain_rad = 1e3;
  constexpr double max_offset = 1e6;
  return usual_span > 0.0 && sensor.low_counts >= -rounding &&
         sensor.high_counts <= counts.max_count + rounding &&
         sensor.high_counts - sensor.low_counts >= (1.0 - rounding) * min_span * usual_span &&
         sensor.line.gain_rad_per_count >= min_gain_rad &&
         sensor.line.gain_rad_per_count <= max_gain_rad &&
         std::abs(sensor.line.offset_counts) <= max_offset;
}

std::optional<LearnedRanges> RangeAdaptation::learned() const noexcept {
  if (!side_) return std::nullopt;
  LearnedRanges learned{*side_, {}};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Learner& learner = learners_[slot];
    if (learner.usual_span == 0.0) continue;
    learned.sensors[slot] = learner.learned(calibration_.sensors[slot]);
  }
  return learned;
}

void RangeAdaptation::Learner::learn(const SwingFinder::End& end) noexcept {
  double& bound = end.is_top ? high : low;
  const double to = drawn(bound, end.counts, end.is_top ? 1.0 : -1.0, end.amplitude, high - low,
                          usual_span, end.is_top ? tops++ : bottoms++);
  const double span = end.is_top ? to - low : high - to;
  if (span >= min_span * usual_span) bound = to;
}

// Between two lines an angle changes most at an end of the counts; there it is bounded, and so for
// every count.
void RangeAdaptation::drift(std::size_t slot, double interval_s) noexcept {
  const Learner& learner = learners_[slot];
  auto& [gain_rad, offset] = calibration_.sensors[slot];
  const double most = counts_.max_count;
  const double goal_gain_rad = learner.usual.gain_rad_per_count / (learner.high - learner.low);
  const double at_zero = -gain_rad * offset;
  const double to_zero =
      learner.usual.angle_rad(RawCount{0}) - goal_gain_rad * learner.low - at_zero;
  const double to_most = to_zero + (goal_gain_rad - gain_rad) * most;
  const double farthest = std::max(std::abs(to_zero), std::abs(to_most));
  const double drift_rad = max_drift_rad_s * interval_s;
  constexpr double rounding_rad = 1e-12;
  if (!(farthest > rounding_rad) || drift_rad == 0.0) return;
  const double part = std::min(drift_rad / farthest, 1.0);
  gain_rad += part * (goal_gain_rad - gain_rad);
  offset = -(at_zero + part * to_zero) / gain_rad;
}

void RangeAdaptation::push(const GloveSample& sample) noexcept {
  if (side_ && sample.side != *side_) *this = RangeAdaptation(counts_);
  const double interval_s = interval_.push(sample);
  side_ = sample.side;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    Learner& learner = learners_[slot];
    if (learner.usual_span == 0.0) continue;
    const std::uint16_t count = std::min(sample.raw[slot].value, counts_.max_count);
    if (!sample.present.has(static_cast<Sensor>(slot))) {
      learner.swings.reset();
    } else if (const auto end = learner.swings.push(count, min_swing * learner.usual_span)) {
      learner.learn(*end);
    }
    drift(slot, interval_s);
  }
}

SensorRanges RangeAdaptation::ranges() const noexcept {
  SensorRanges ranges;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    ranges[slot] = learners_[slot].range();
  return ranges;
}

} // namespace nendo::hand
