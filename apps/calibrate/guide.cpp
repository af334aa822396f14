#include "calibrate/guide.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::app {
namespace {

using hand::AssumedAngle;
using hand::HeldPose;
using hand::PoseId;

// How far a joint may be from where the pose has it before it is taken for another pose: wearers
// differ, and so do the two poses by which their sensors are judged.
constexpr double most_doubt_rad = from_degrees(40.0);
constexpr double deviations_allowed = 3.0;

} // namespace

CalibrationGuide::CalibrationGuide(std::span<const PoseId> poses, CountScale scale)
    : poses_(poses), kept_(poses.size()), capture_(scale) {}

CalibrationGuide::Event CalibrationGuide::see(const GloveSample& sample) {
  if (is_done()) return Event::none;
  if (capture_.push(sample) != hand::CaptureState::held) return Event::none;
  const HeldPose held = capture_.held();
  capture_.begin_next();
  doubted_ = implausible_sensor(held);
  if (doubted_) return Event::implausible;
  kept_[at_] = held;
  advance();
  return Event::captured;
}

/// To the next pose that is not kept yet.
void CalibrationGuide::advance() {
  while (at_ < poses_.size() && kept_[at_])
    ++at_;
}

void CalibrationGuide::go_back() {
  while (at_ > 0) {
    --at_;
    if (!kept_[at_]) continue; // was skipped
    kept_[at_].reset();
    break;
  }
  doubted_.reset();
}

void CalibrationGuide::skip() {
  doubted_.reset();
  if (is_done()) return;
  ++at_;
  advance();
  if (!is_done()) return;
  // Without these two there is no calibration.
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    if ((poses_[k] == PoseId::flat || poses_[k] == PoseId::fist) && !kept_[k]) {
      at_ = k;
      return;
    }
  }
}

void CalibrationGuide::restore(std::span<const hand::PoseReading> readings) {
  for (const auto& reading : readings) {
    const auto found = std::find(poses_.begin(), poses_.end(), reading.pose);
    if (found != poses_.end())
      kept_[static_cast<std::size_t>(found - poses_.begin())] = reading.held;
  }
  at_ = 0;
  advance();
}

std::vector<hand::PoseReading> CalibrationGuide::readings() const {
  std::vector<hand::PoseReading> readings;
  for (std::size_t k = 0; k < poses_.size(); ++k)
    if (kept_[k]) readings.push_back({poses_[k], *kept_[k]});
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

/// Judged by the lines through flat and fist, once both are kept.
std::optional<Sensor> CalibrationGuide::implausible_sensor(const HeldPose& held) const {
  const HeldPose* flat = kept(PoseId::flat);
  const HeldPose* fist = kept(PoseId::fist);
  if (flat == nullptr || fist == nullptr) return std::nullopt;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const AssumedAngle& at_flat = hand::pose_of(PoseId::flat).assumed[slot];
    const AssumedAngle& at_fist = hand::pose_of(PoseId::fist).assumed[slot];
    const AssumedAngle& expected = hand::pose_of(asked()).assumed[slot];
    const double counts = fist->mean_counts[slot] - flat->mean_counts[slot];
    const double turn_rad = at_fist.angle_rad - at_flat.angle_rad;
    // Only joints that the two poses tell well apart can judge a third.
    if (!held.present.has(static_cast<Sensor>(slot)) || !at_flat.known() || !at_fist.known() ||
        !expected.known() || turn_rad < 2.0 * (at_flat.deviation_rad + at_fist.deviation_rad) ||
        std::abs(counts) < hand::PoseCapture::least_change_counts)
      continue;
    const double angle_rad =
        at_flat.angle_rad + turn_rad / counts * (held.mean_counts[slot] - flat->mean_counts[slot]);
    if (std::abs(angle_rad - expected.angle_rad) >
        most_doubt_rad + deviations_allowed * expected.deviation_rad)
      return static_cast<Sensor>(slot);
  }
  return std::nullopt;
}

} // namespace nendo::app
