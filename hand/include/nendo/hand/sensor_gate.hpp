#pragma once
// The velocity gate: keeps out counts that no hand can have caused. A flipped bit in a sensor's
// byte leaves a record well formed, and few gloves send a checksum. But such a count is far off in
// one record and right again in the next, and a joint needs time to go and come back.

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
  /// How far noise and the converter's steps may change an angle in addition: four counts of a
  /// CyberGlove.
  static constexpr double noise_rad = 0.05;
  /// Without a glove's own clock, times of arrival say little about when a sample was taken,
  /// because serial adapters hand over bytes every 16 ms. An interval then counts as at least that
  /// long.
  static constexpr double min_arrival_interval_s = 0.016;

  /// Takes the next sample in time and returns the sample to use instead of it. The gains of
  /// `calibration` say how far a count turns a joint; it must be that of the glove that sent this
  /// sample, which may not have sent the last one. A sensor that jumped farther than a joint can
  /// turn since its last accepted count is held at that count for this one sample. Its next count
  /// is always accepted, so that a real jump is only one sample late. A sensor that was absent
  /// before, or on the other hand, is accepted. Wait-free.
  GloveSample pass(const GloveSample& sample, const Calibration& calibration) noexcept;

  /// Returns by slot how often a jump was kept out and came back, that is, was no movement.
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
