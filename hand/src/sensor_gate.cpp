#include <nendo/hand/sensor_gate.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace nendo::hand {
namespace {

int distance(RawCount a, RawCount b) noexcept {
  return std::abs(int{a.value} - int{b.value});
}

} // namespace

SensorGate::SensorGate(const Calibration& calibration) noexcept {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    gains_rad_[slot] = std::abs(calibration.sensors[slot].gain_rad_per_count);
  }
}

bool SensorGate::is_movement(std::size_t slot, RawCount count, double elapsed_s) const noexcept {
  const double jump_rad = gains_rad_[slot] * distance(count, accepted_[slot].count);
  // A gain that is not a number tells nothing of the joint: let it pass.
  return !(jump_rad > noise_rad + most_speed_rad_s * elapsed_s);
}

GloveSample SensorGate::pass(const GloveSample& sample) noexcept {
  const bool same_hand = sample.side == side_;
  side_ = sample.side;
  const HostTime time = sample.has_device_time ? sample.measured : sample.arrival;
  const double least_s = sample.has_device_time ? 0.0 : least_arrival_interval_s;
  GloveSample passed = sample;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    Accepted& last = accepted_[slot];
    if (!sample.present.has(static_cast<Sensor>(slot))) {
      last = {};
      continue;
    }
    const RawCount count = sample.raw[slot];
    const bool comparable = last.known && same_hand;
    // Clocks are the glove's word: time that runs backwards is no time.
    const double elapsed_s = std::max(to_seconds(time - last.time), least_s);
    if (comparable && !last.holding && !is_movement(slot, count, elapsed_s)) {
      last.holding = true;
      last.refused = count;
      passed.raw[slot] = last.count;
      continue;
    }
    const bool came_back = distance(count, last.count) < distance(count, last.refused);
    if (comparable && last.holding && came_back) ++spikes_[slot];
    last = {time, count, {}, true, false};
  }
  return passed;
}

} // namespace nendo::hand
