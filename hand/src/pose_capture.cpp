#include <nendo/hand/pose_capture.hpp>

#include <algorithm>
#include <cmath>

namespace nendo::hand {
namespace {

/// How long the measure of noise remembers.
constexpr double noise_memory_s = 0.3;

} // namespace

PoseCapture::PoseCapture(CountScale scale) noexcept
    : scale_(scale), unit_(std::max(scale.max_count / 255.0, 0.5)) {}

void PoseCapture::begin_window(const GloveSample& sample, HostTime now) noexcept {
  begun_ = now;
  samples_ = 0;
  progress_ = 0.0;
  for (const Sensor sensor : present_) {
    Watched& watched = watched_[index_of(sensor)];
    watched.low_counts = watched.high_counts = sample.raw[index_of(sensor)].value;
    watched.mean_counts = watched.squares = 0.0;
    watched.at_end = 0;
  }
}

void PoseCapture::watch_noise(const GloveSample& sample, double elapsed_s) noexcept {
  const double share = 1.0 - std::exp(-std::max(elapsed_s, 0.001) / noise_memory_s);
  for (const Sensor sensor : present_) {
    Watched& watched = watched_[index_of(sensor)];
    const double counts = sample.raw[index_of(sensor)].value;
    // The second difference of white noise has six times its variance.
    const double second = counts - 2.0 * watched.before_counts + watched.earlier_counts;
    if (seen_ >= 2)
      watched.noise_variance += share * (second * second / 6.0 - watched.noise_variance);
    watched.earlier_counts = seen_ >= 1 ? watched.before_counts : counts;
    watched.before_counts = counts;
  }
  seen_ = std::min(seen_ + 1, 3U);
}

void PoseCapture::add(const GloveSample& sample) noexcept {
  ++samples_;
  for (const Sensor sensor : present_) {
    Watched& watched = watched_[index_of(sensor)];
    const double counts = sample.raw[index_of(sensor)].value;
    watched.low_counts = std::min(watched.low_counts, counts);
    watched.high_counts = std::max(watched.high_counts, counts);
    const double off = counts - watched.mean_counts;
    watched.mean_counts += off / samples_;
    watched.squares += off * (counts - watched.mean_counts);
    // 8-bit gloves never send 0. Gloves that know their whole range may well be at its end.
    const bool end = counts <= 1.0 || counts >= scale_.max_count;
    if (end && !scale_.self_calibrated) ++watched.at_end;
  }
}

SensorMask PoseCapture::restless() const noexcept {
  SensorMask mask;
  const double most = still_range_counts * unit_;
  for (const Sensor sensor : present_) {
    if (watched_[index_of(sensor)].high_counts - watched_[index_of(sensor)].low_counts > most)
      mask.add(sensor);
  }
  return mask;
}

SensorMask PoseCapture::at_ends() const noexcept {
  SensorMask mask;
  for (const Sensor sensor : present_) {
    if (2 * watched_[index_of(sensor)].at_end > samples_) mask.add(sensor);
  }
  return mask;
}

bool PoseCapture::differs_from_last() const noexcept {
  if (!(last_.present == present_)) return true;
  bool differs = false;
  for (const Sensor sensor : present_) {
    const double change =
        std::abs(watched_[index_of(sensor)].mean_counts - last_.mean_counts[index_of(sensor)]);
    differs = differs || change >= min_change_counts * unit_;
  }
  return differs;
}

void PoseCapture::fill_held() noexcept {
  held_ = {};
  held_.present = present_;
  for (const Sensor sensor : present_) {
    held_.mean_counts[index_of(sensor)] = watched_[index_of(sensor)].mean_counts;
    held_.noise_counts[index_of(sensor)] = std::sqrt(watched_[index_of(sensor)].squares / samples_);
  }
}

CaptureState PoseCapture::state_in_movement(SensorMask moved) noexcept {
  SensorMask jumping;
  for (const Sensor sensor : moved) {
    if (watched_[index_of(sensor)].noise_variance > std::pow(max_noise_counts * unit_, 2))
      jumping.add(sensor);
  }
  troubled_ = jumping.bits != 0 ? jumping : moved;
  return jumping.bits != 0 ? CaptureState::noisy : CaptureState::moving;
}

CaptureState PoseCapture::state_at_rest(double still_s) noexcept {
  progress_ = 0.0;
  const SensorMask ends = at_ends();
  if (ends.bits != 0) {
    troubled_ = ends;
    return CaptureState::saturated;
  }
  const double done = std::min(still_s / hold_s, static_cast<double>(samples_) / min_samples);
  // Not before the mean is one: the hand may have come to rest here on its way.
  if (done >= 0.25 && !differs_from_last()) return CaptureState::unchanged;
  if (done < 1.0) {
    progress_ = done;
    // While the measure of noise remembers, the reason stays the same: a display would flicker.
    const bool restless_before = state_ == CaptureState::noisy || state_ == CaptureState::moving;
    if (!restless_before || still_s >= noise_memory_s) return CaptureState::settling;
    troubled_ = last_troubled_;
    return state_;
  }
  fill_held();
  progress_ = 1.0;
  return CaptureState::held;
}

CaptureState PoseCapture::push(const GloveSample& sample) noexcept {
  if (state_ == CaptureState::held) return state_;
  const HostTime now = sample.time();
  const double elapsed_s = to_seconds(now - last_time_);
  last_time_ = now;
  last_troubled_ = troubled_;
  troubled_ = {};
  if (!(sample.present == present_)) seen_ = 0;
  if (seen_ == 0) {
    watched_ = {};
    present_ = sample.present;
  }
  if (present_.bits == 0) {
    progress_ = 0.0;
    return state_ = CaptureState::waiting;
  }
  // A pause of the stream is no rest of the hand.
  const bool broken = seen_ == 0 || elapsed_s < 0.0 || elapsed_s > hold_s / 2;
  watch_noise(sample, broken ? 0.0 : elapsed_s);
  if (broken) begin_window(sample, now);
  add(sample);
  const SensorMask moved = restless();
  if (moved.bits == 0) return state_ = state_at_rest(to_seconds(now - begun_));
  state_ = state_in_movement(moved);
  begin_window(sample, now);
  add(sample);
  return state_;
}

void PoseCapture::begin_next() noexcept {
  if (state_ == CaptureState::held) last_ = held_;
  seen_ = 0;
  progress_ = 0.0;
  state_ = CaptureState::waiting;
}

} // namespace nendo::hand
