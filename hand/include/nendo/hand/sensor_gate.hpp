#pragma once
// The velocity gate: rejects counts that no hand can have caused. A flipped bit in a sensor's byte
// leaves a record well formed, and few gloves send a checksum. But such a spike lasts one record,
// and a joint needs longer to move there and back.

#include <array>
#include <cstdint>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>

namespace nendo::hand {

class NENDO_API SensorGate {
public:
  /// Fast finger flexion peaks near 20 to 25 rad/s (flicks and taps at full effort); the wrist and
  /// spreading are slower.
  static constexpr double max_speed_rad_s = 25.0;
  /// The additional tolerance for noise and quantization: four counts of a CyberGlove.
  static constexpr double noise_rad = 0.05;
  /// Without a glove's own clock, sample times are arrival times, which are inexact, because serial
  /// adapters deliver bytes every 16 ms. An interval then counts as at least that long.
  static constexpr double min_arrival_interval_s = 0.016;

  /// Takes the next sample in time order and returns the sample to use instead of it.
  /// `calibration`, whose gains convert counts to angles, must be that of the glove that sent this
  /// sample; the previous sample may be of another glove. A sensor that jumped farther than a joint
  /// can turn since its last accepted count is held at that count for this one sample. Its next
  /// count is always accepted, so that a real jump is delayed by only one sample. The first count
  /// after an absence or a change of hand is accepted. Wait-free.
  GloveSample pass(const GloveSample& sample, const Calibration& calibration) noexcept;

  /// Returns, by slot, the number of rejected jumps that came back and so were no movements.
  const std::array<std::uint64_t, sensor_slots>& spikes() const noexcept { return spikes_; }

private:
  struct Accepted {
    HostTime time{};
    RawCount count;
    RawCount refused; ///< the count just rejected, if `holding`
    bool known = false;
    bool holding = false;
  };
  std::array<Accepted, sensor_slots> accepted_{};
  std::array<std::uint64_t, sensor_slots> spikes_{};
  Side side_ = Side::right;
};

} // namespace nendo::hand
