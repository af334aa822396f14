#include "calibrate/still_sensors.hpp"

#include <algorithm>

#include <nendo/hand/calibration_poses.hpp>

namespace nendo::calibrate {
namespace {

using hand::PoseId;

constexpr std::size_t min_poses = 3;
/// After so many poses a sensor has moved, whatever they ask of its joint.
constexpr std::size_t enough_poses = 12;
constexpr double min_span_rad = from_degrees(40.0); ///< span of joints that poses bend far
constexpr double min_small_span_rad = from_degrees(14.0);

bool bends_far(Sensor sensor) noexcept {
  return !is_gap(sensor) && sensor != Sensor::palm_arch && sensor != Sensor::wrist_yaw;
}

/// Returns whether the poses ask for angles of that sensor which no still joint can have.
bool asks_to_move(std::span<const PoseId> poses, std::size_t slot) {
  if (poses.size() >= enough_poses) return true;
  if (poses.size() < min_poses) return false;
  double least = 1e9, most = -1e9;
  for (const PoseId pose : poses) {
    const hand::AssumedAngle& asked = hand::pose_of(pose).assumed[slot];
    if (!asked.known()) continue;
    least = std::min(least, asked.angle_rad);
    most = std::max(most, asked.angle_rad);
  }
  return most - least >= (bends_far(static_cast<Sensor>(slot)) ? min_span_rad : min_small_span_rad);
}

} // namespace

void StillSensors::push(const GloveSample& sample) {
  if (begun_ && sample.time() == last_) return; // the same, of which another part asks
  watch_.push(sample);
  const bool first = !begun_;
  if (first) begun_ = sample.time();
  last_ = sample.time();
  for (const Sensor sensor : sample.present) {
    const std::size_t slot = index_of(sensor);
    Seen& seen = seen_[slot];
    const std::uint16_t count = sample.raw[slot].value;
    if (!present_.has(sensor)) {
      present_.add(sensor);
      seen = {count, count, count, count, poses_.size(), !first};
      continue;
    }
    seen.least = std::min(seen.least, count);
    seen.most = std::max(seen.most, count);
    seen.low = std::min(seen.low, count);
    seen.high = std::max(seen.high, count);
    if (hand::is_still(seen.low, seen.high, scale_)) continue;
    seen.low = seen.high = count;
    seen.changed_after = poses_.size();
    seen.changed = true;
  }
}

std::span<const PoseId> StillSensors::poses_since_change(std::size_t slot) const {
  return std::span(poses_).subspan(seen_[slot].changed_after);
}

bool StillSensors::contradicts(Sensor sensor, PoseId pose) const {
  const auto slot = index_of(sensor);
  const auto before = poses_since_change(slot);
  std::vector<PoseId> poses(before.begin(), before.end());
  poses.push_back(pose);
  return asks_to_move(poses, slot);
}

/// Returns whether so many per cent of the other sensors have moved over so many counts of 255.
bool StillSensors::others_moved(std::size_t slot, double counts, int part) const {
  int others = 0, moved = 0;
  for (std::size_t other = 0; other < sensor_slots; ++other) {
    if (other == slot || !present_.has(static_cast<Sensor>(other))) continue;
    ++others;
    if (seen_[other].most - seen_[other].least >= counts * scale_.max_count / 255.0) ++moved;
  }
  return moved >= 4 && 100 * moved >= part * others;
}

SensorMask StillSensors::stuck() const {
  constexpr double patience_s = 5.0;
  SensorMask found = watch_.stuck();
  if (!begun_) return found;
  const bool long_enough = seconds_between(*begun_, last_) >= patience_s;
  for (const Sensor sensor : present_) {
    const std::size_t slot = index_of(sensor);
    const Seen& seen = seen_[slot];
    const bool at_end = hand::is_at_end(seen.low, scale_) && !seen.changed;
    const bool rests = hand::rests_at_end(seen.low, seen.high, scale_);
    if ((!rests && asks_to_move(poses_since_change(slot), slot)) ||
        (long_enough && at_end && others_moved(slot, 16.0, 40)))
      found.add(sensor);
  }
  return found;
}

SensorMask StillSensors::still_in_free_motion() const {
  SensorMask found;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    if (present_.has(sensor) && !seen_[slot].changed && others_moved(slot, 40.0, 60))
      found.add(sensor);
  }
  return found;
}

SensorMask still_in(const std::vector<hand::PoseReading>& readings, CountScale scale) {
  SensorMask found;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    std::vector<PoseId> poses;
    double least = 1e9, most = -1e9;
    for (const auto& [pose, held] : readings) {
      if (!held.present.has(sensor)) continue;
      poses.push_back(pose);
      least = std::min(least, held.mean_counts[slot]);
      most = std::max(most, held.mean_counts[slot]);
    }
    if (!hand::rests_at_end(least, most, scale) && most - least <= scale.max_count / 1024.0 &&
        most - least < 1.0 && asks_to_move(poses, slot))
      found.add(sensor);
  }
  return found;
}

} // namespace nendo::calibrate
