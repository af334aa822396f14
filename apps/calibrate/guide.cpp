#include "calibrate/guide.hpp"

#include <algorithm>
#include <cmath>

#include <nendo/hand/calibration_poses.hpp>

namespace nendo::calibrate {
namespace {

using hand::AssumedAngle;
using hand::HeldPose;
using hand::PoseId;

/// Returns how far fist has a joint bent from flat, or 0 if wearers do not repeat the two poses
/// exactly enough to separate them.
double bend_rad(std::size_t slot) {
  const AssumedAngle& flat = hand::pose_of(PoseId::flat).assumed[slot];
  const AssumedAngle& fist = hand::pose_of(PoseId::fist).assumed[slot];
  if (!flat.known() || !fist.known()) return 0.0;
  const double turn_rad = fist.angle_rad - flat.angle_rad;
  return turn_rad < 2.0 * (flat.deviation_rad + fist.deviation_rad) ? 0.0 : turn_rad;
}

// How far a joint may be from where the pose has it before it is taken for another pose: wearers
// differ, and so do the two poses by which their sensors are judged.
constexpr double max_doubt_rad = from_degrees(40.0);
constexpr double deviations_allowed = 3.0;

} // namespace

CalibrationGuide::CalibrationGuide(std::span<const PoseId> poses, CountScale scale,
                                   SensorMask stiff)
    : scale_(scale), stiff_(stiff), planned_(poses.begin(), poses.end()), poses_(planned_),
      kept_(poses.size()), capture_(scale), still_(scale) {}

void CalibrationGuide::push_free_motion(const GloveSample& sample) {
  free_motion_.push(sample);
  still_.push(sample);
  leave_out_stuck(still_.stuck());
}

void CalibrationGuide::end_free_motion() {
  leave_out_stuck(still_.still_in_free_motion());
}

hand::CountRanges CalibrationGuide::free_motion() const noexcept {
  hand::CountRanges seen = free_motion_.seen();
  seen.present.bits &= ~left_out_.bits;
  return seen;
}

CalibrationGuide::Event CalibrationGuide::push(const GloveSample& sample) {
  if (is_done()) return Event::none;
  still_.push(sample);
  leave_out_stuck(still_.stuck());
  GloveSample usable = sample;
  usable.present.bits &= ~left_out_.bits;
  const hand::CaptureState state = capture_.push(usable);
  const bool moves = state == hand::CaptureState::moving || state == hand::CaptureState::noisy;
  if (same_may_come_ && moves) {
    capture_.forget_last();
    same_may_come_ = false;
  }
  if (state != hand::CaptureState::held) return Event::none;
  HeldPose held = capture_.held();
  capture_.begin_next();
  implausible_ = find_unbent(held);
  if (!implausible_) implausible_ = find_implausible(held);
  while (implausible_ && still_.contradicts(*implausible_, asked())) {
    const SensorMask before = left_out_;
    SensorMask stuck;
    stuck.add(*implausible_);
    leave_out_stuck(stuck);
    if (left_out_ == before) break;
    held.present.bits &= ~left_out_.bits;
    implausible_ = find_implausible(held);
  }
  if (implausible_) return Event::implausible;
  still_.captured(asked());
  kept_[at_] = held;
  same_may_come_ = false;
  advance();
  return Event::captured;
}

void CalibrationGuide::advance() {
  while (at_ < poses_.size() && kept_[at_])
    ++at_;
}

/// Accepts the pose that was held last once more, but only after the hand has moved.
void CalibrationGuide::ask_again() noexcept {
  same_may_come_ = true;
  implausible_.reset();
}

/// Returns the number of the kept pose before the one asked for, or -1.
std::ptrdiff_t CalibrationGuide::last_kept() const noexcept {
  auto last = static_cast<std::ptrdiff_t>(at_) - 1;
  while (last >= 0 && !kept_[static_cast<std::size_t>(last)])
    --last; // it was skipped
  return last;
}

bool CalibrationGuide::is_again() const noexcept {
  for (std::size_t k = 0; k < at_; ++k)
    if (poses_[k] == poses_[at_] && kept_[k]) return true;
  return false;
}

void CalibrationGuide::ask_for(std::size_t number) {
  at_ = number;
  kept_[at_].reset();
  ask_again();
}

void CalibrationGuide::go_back() {
  ask_for(static_cast<std::size_t>(std::max<std::ptrdiff_t>(last_kept(), 0)));
}

void CalibrationGuide::take_again() {
  const std::ptrdiff_t last = last_kept();
  if (last < 0 || is_done()) return;
  const PoseId pose = poses_[static_cast<std::size_t>(last)];
  const auto takes = static_cast<std::size_t>(std::count(poses_.begin(), poses_.end(), pose));
  if (asked() == pose || takes >= max_takes) return;
  const auto at = static_cast<std::ptrdiff_t>(at_);
  poses_.insert(poses_.begin() + at, pose);
  kept_.insert(kept_.begin() + at, std::nullopt);
  ask_again();
}

void CalibrationGuide::skip() {
  implausible_.reset();
  if (is_done()) return;
  ++at_;
  advance();
  if (!is_done()) return;
  // Without these two there is no calibration.
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    if ((poses_[k] == PoseId::flat || poses_[k] == PoseId::fist) && kept(poses_[k]) == nullptr) {
      at_ = k;
      return;
    }
  }
}

void CalibrationGuide::reset() {
  poses_ = planned_;
  kept_.assign(poses_.size(), std::nullopt);
  free_motion_ = hand::RangeCapture();
  still_ = StillSensors(scale_);
  left_out_ = {};
  at_ = 0;
  ask_again();
}

void CalibrationGuide::restore(std::span<const hand::PoseReading> readings,
                               const hand::CountRanges& free_motion) {
  free_motion_ = hand::RangeCapture(free_motion);
  for (const auto& reading : readings) {
    std::size_t takes = 0, end = 0; // of this pose, and where its last one ends
    std::optional<std::size_t> free_place;
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      if (poses_[k] != reading.pose) continue;
      ++takes;
      end = k + 1;
      if (!kept_[k] && !free_place) free_place = k;
    }
    if (takes == 0 || (!free_place && takes >= max_takes)) continue;
    if (!free_place) {
      poses_.insert(poses_.begin() + static_cast<std::ptrdiff_t>(end), reading.pose);
      kept_.insert(kept_.begin() + static_cast<std::ptrdiff_t>(end), std::nullopt);
      free_place = end;
    }
    kept_[*free_place] = reading.held;
  }
  at_ = 0;
  advance();
  // The hand that continues is often still in the pose before.
  if (const std::ptrdiff_t last = last_kept(); last >= 0)
    capture_.set_last(*kept_[static_cast<std::size_t>(last)]);
}

std::vector<hand::PoseReading> CalibrationGuide::readings() const {
  std::vector<hand::PoseReading> readings;
  for (std::size_t k = 0; k < poses_.size(); ++k)
    if (kept_[k]) {
      readings.push_back({poses_[k], *kept_[k]});
      readings.back().held.present.bits &= ~left_out_.bits;
    }
  return readings;
}

bool CalibrationGuide::has_any() const noexcept {
  return std::any_of(kept_.begin(), kept_.end(), [](const auto& kept) { return kept.has_value(); });
}

const HeldPose* CalibrationGuide::kept(PoseId pose) const {
  for (std::size_t k = 0; k < poses_.size(); ++k)
    if (poses_[k] == pose && kept_[k]) return &*kept_[k];
  return nullptr;
}

/// Where flat and fist are held one after the other, returns the sensor that changed least between
/// them, if most of those that should rise did not: a fist cannot be what the flat hand was. One or
/// two such sensors may be broken, which the fit says.
std::optional<Sensor> CalibrationGuide::find_unbent(const HeldPose& held) const {
  const PoseId now = asked();
  if (now != PoseId::flat && now != PoseId::fist) return std::nullopt;
  const HeldPose* other = kept(now == PoseId::flat ? PoseId::fist : PoseId::flat);
  if (other == nullptr) return std::nullopt;
  const hand::Calibration usual = hand::default_calibration(scale_);
  const double min_counts = hand::PoseCapture::min_change_counts * scale_.max_count / 255.0;
  std::optional<Sensor> worst;
  double worst_counts = min_counts;
  int judged = 0, unbent = 0;
  for (const Sensor sensor : held.present) {
    const std::size_t slot = index_of(sensor);
    const double gain = usual.sensors[slot].gain_rad_per_count;
    if (!other->present.has(sensor) || stiff_.has(sensor) || bend_rad(slot) == 0.0 || gain == 0.0)
      continue;
    ++judged;
    const double rise = (now == PoseId::fist ? 1.0 : -1.0) * (gain > 0.0 ? 1.0 : -1.0) *
                        (held.mean_counts[slot] - other->mean_counts[slot]);
    if (rise >= min_counts) continue;
    ++unbent;
    if (!worst || rise < worst_counts) {
      worst = sensor;
      worst_counts = rise;
    }
  }
  return 2 * unbent > judged ? worst : std::nullopt;
}

/// Returns a sensor whose angle the pose asked for cannot have. The angles are those of the lines
/// through flat and fist, so nothing is implausible before both are kept.
std::optional<Sensor> CalibrationGuide::find_implausible(const HeldPose& held) const {
  const HeldPose* flat = kept(PoseId::flat);
  const HeldPose* fist = kept(PoseId::fist);
  if (flat == nullptr || fist == nullptr) return std::nullopt;
  for (const Sensor sensor : held.present) {
    const std::size_t slot = index_of(sensor);
    const AssumedAngle& at_flat = hand::pose_of(PoseId::flat).assumed[slot];
    const AssumedAngle& expected = hand::pose_of(asked()).assumed[slot];
    const double counts = fist->mean_counts[slot] - flat->mean_counts[slot];
    const double turn_rad = bend_rad(slot);
    // Only joints that the two poses separate well can judge a third.
    if (stiff_.has(sensor) || turn_rad == 0.0 || !expected.known() ||
        std::abs(counts) < hand::PoseCapture::min_change_counts)
      continue;
    const double angle_rad =
        at_flat.angle_rad + turn_rad / counts * (held.mean_counts[slot] - flat->mean_counts[slot]);
    if (std::abs(angle_rad - expected.angle_rad) >
        max_doubt_rad + deviations_allowed * expected.deviation_rad)
      return sensor;
  }
  return std::nullopt;
}

} // namespace nendo::calibrate
