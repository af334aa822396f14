#pragma once
// The velocity gate: keeps out counts that no hand can have caused. A flipped bit in a sensor's
// byte leaves a record well formed, and few gloves send a checksum; but it is far off in one record
// and gone in the next, and a joint needs time to go and come back.

#include <array>
#include <cstdint>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>

namespace nendo::hand {

class SensorGate {
public:
  /// Fast finger flexion peaks near 20 to 25 rad/s (flicks and taps at full effort); the wrist and
  /// spreading are slower.
  static constexpr double most_speed_rad_s = 25.0;
  /// What noise and the converter's steps may add to any change: four counts of a CyberGlove.
  static constexpr double noise_rad = 0.05;
  /// Without a glove's own clock, times of arrival tell little of when a sample was taken: serial
  /// adapters hand over bytes every 16 ms. An interval is then taken as that long at least.
  static constexpr double least_arrival_interval_s = 0.016;

  /// The sample to use instead of this one, next in time. The gains of its calibration tell how far
  /// a count turns a joint: they are those of the glove that sent it, which may not be the one that
  /// sent the last. A sensor that jumped farther than a joint can turn since its last accepted
  /// count is held at that count, for this one sample; whatever comes next is accepted, so that a
  /// real jump is a sample late and no more. A sensor that was absent before, or on the other hand,
  /// is accepted. Wait-free.
  GloveSample pass(const GloveSample& sample, const Calibration& calibration) noexcept;

  /// By slot: how often a jump was kept out and came back, that is, was no movement.
  const std::array<std::uint64_t, sensor_slots>& spikes() const noexcept { return spikes_; }

private:
  struct Accepted {
    HostTime time{};
    RawCount count;
    RawCount refused; ///< what came instead of it just now, if `holding`
    bool known = false;
    bool holding = false;
  };
  std::array<Accepted, sensor_slots> accepted_{};
  std::array<std::uint64_t, sensor_slots> spikes_{};
  Side side_ = Side::right;
};

} // namespace nendo::hand
