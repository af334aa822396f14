#include <nendo/hand/sensor_gate.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace nendo::hand {
namespace {

int distance(RawCount a, RawCount b) noexcept {
  return std::abs(int{a.value} - int{b.value});
}

bool is_movement(double jump_rad, double elapsed_s) noexcept {
  // A gain that is not a number says nothing about the joint: let it pass.
  return !(jump_rad > SensorGate::noise_rad + SensorGate::max_speed_rad_s * elapsed_s);
}

} // namespace

GloveSample SensorGate::pass(const GloveSample& sample, const Calibration& calibration) noexcept {
  const bool same_hand = sample.side == side_;
  side_ = sample.side;
  const HostTime time = sample.time();
  const double min_s = sample.has_device_time ? 0.0 : min_arrival_interval_s;
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
    const double elapsed_s = std::max(seconds_between(last.time, time), min_s);
    const double jump_rad =
        std::abs(calibration.sensors[slot].gain_rad_per_count) * distance(count, last.count);
    if (comparable && !last.holding && !is_movement(jump_rad, elapsed_s)) {
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
