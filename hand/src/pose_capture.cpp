#include <nendo/hand/pose_capture.hpp>

#include <algorithm>
#include <cmath>

namespace nendo::hand {
namespace {

/// How long the measure of noise remembers.
constexpr double noise_memory_s = 0.3;

template <class Function>
void for_each(SensorMask mask, Function&& function) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (mask.has(static_cast<Sensor>(slot))) function(slot);
  }
}

} // namespace

PoseCapture::PoseCapture(CountScale scale) noexcept
    : scale_(scale), unit_(std::max(scale.most / 255.0, 0.5)) {}

void PoseCapture::begin_window(const GloveSample& sample, HostTime now) noexcept {
  begun_ = now;
  samples_ = 0;
  progress_ = 0.0;
  for_each(present_, [&](std::size_t slot) {
    Watched& sensor = watched_[slot];
    sensor.low_counts = sensor.high_counts = sample.raw[slot].value;
    sensor.mean_counts = sensor.squares = 0.0;
    sensor.at_end = 0;
  });
}

void PoseCapture::watch_noise(const GloveSample& sample, double elapsed_s) noexcept {
  const double share = 1.0 - std::exp(-std::max(elapsed_s, 0.001) / noise_memory_s);
  for_each(present_, [&](std::size_t slot) {
    Watched& sensor = watched_[slot];
    const double counts = sample.raw[slot].value;
    // The second difference of white noise has six times its variance.
    const double second = counts - 2.0 * sensor.before_counts + sensor.earlier_counts;
    if (seen_ >= 2)
      sensor.noise_variance += share * (second * second / 6.0 - sensor.noise_variance);
    sensor.earlier_counts = seen_ >= 1 ? sensor.before_counts : counts;
    sensor.before_counts = counts;
  });
  seen_ = std::min(seen_ + 1, 3U);
}

void PoseCapture::add(const GloveSample& sample) noexcept {
  ++samples_;
  for_each(present_, [&](std::size_t slot) {
    Watched& sensor = watched_[slot];
    const double counts = sample.raw[slot].value;
    sensor.low_counts = std::min(sensor.low_counts, counts);
    sensor.high_counts = std::max(sensor.high_counts, counts);
    const double off = counts - sensor.mean_counts;
    sensor.mean_counts += off / samples_;
    sensor.squares += off * (counts - sensor.mean_counts);
    // 8-bit gloves never send 0. Gloves that know their whole range may well be at its end.
    const bool end = counts <= 1.0 || counts >= scale_.most;
    if (end && !scale_.whole_range) ++sensor.at_end;
  });
}

SensorMask PoseCapture::restless() const noexcept {
  SensorMask mask;
  const double most = still_range_counts * unit_;
  for_each(present_, [&](std::size_t slot) {
    if (watched_[slot].high_counts - watched_[slot].low_counts > most)
      mask.add(static_cast<Sensor>(slot));
  });
  return mask;
}

SensorMask PoseCapture::at_ends() const noexcept {
  SensorMask mask;
  for_each(present_, [&](std::size_t slot) {
    if (2 * watched_[slot].at_end > samples_) mask.add(static_cast<Sensor>(slot));
  });
  return mask;
}

bool PoseCapture::differs_from_last() const noexcept {
  if (!(last_.present == present_)) return true;
  bool differs = false;
  for_each(present_, [&](std::size_t slot) {
    const double change = std::abs(watched_[slot].mean_counts - last_.mean_counts[slot]);
    differs = differs || change >= min_change_counts * unit_;
  });
  return differs;
}

void PoseCapture::fill_held() noexcept {
  held_ = {};
  held_.present = present_;
  for_each(present_, [&](std::size_t slot) {
    held_.mean_counts[slot] = watched_[slot].mean_counts;
    held_.noise_counts[slot] = std::sqrt(watched_[slot].squares / samples_);
  });
}

CaptureState PoseCapture::state_in_movement(SensorMask moved) noexcept {
  SensorMask jumping;
  for_each(moved, [&](std::size_t slot) {
    if (watched_[slot].noise_variance > std::pow(max_noise_counts * unit_, 2))
      jumping.add(static_cast<Sensor>(slot));
  });
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
