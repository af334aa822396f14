#pragma once
// Captures a held pose from a stream of samples: waits until the hand has been still for a second,
// and reports why it still waits.

#include <array>
#include <cstdint>

#include <nendo/driver/sample.hpp>

namespace nendo::hand {

struct HeldPose {
  std::array<double, sensor_slots> mean_counts{};
  std::array<double, sensor_slots> noise_counts{}; ///< standard deviation of one sample
  SensorMask present;                              ///< the slots that have both values
};

enum class CaptureState : std::uint8_t {
  waiting,   ///< no sample yet, or no sensors in it
  moving,    ///< some sensor changes; troubled() says which
  noisy,     ///< some sensor jumps to and fro faster than a joint could
  saturated, ///< still, but some sensor is at an end of its counts half the time
  unchanged, ///< still, but in the last held pose
  settling,  ///< still, but not yet for long enough
  held,      ///< held() is complete
};

/// Watches samples until a pose is held. Wait-free, no allocation.
class NENDO_API PoseCapture {
public:
  /// These limits are for 255 counts. They are proportional for other scales, but never so low that
  /// a flickering last bit exceeds them.
  static constexpr double still_range_counts = 6.0;
  static constexpr double max_noise_counts = 2.0;
  static constexpr double min_change_counts = 8.0;
  static constexpr double hold_s = 1.0;
  static constexpr std::uint32_t min_samples = 10; ///< within hold_s

  explicit PoseCapture(CountScale scale = {}) noexcept;

  /// Takes samples in time order. Once the state is held, nothing changes until begin_next().
  CaptureState push(const GloveSample& sample) noexcept;

  CaptureState state() const noexcept { return state_; }
  /// Returns the sensors that prevent capture, if the state is moving, noisy or saturated.
  SensorMask troubled() const noexcept { return troubled_; }
  /// Returns the elapsed fraction of hold_s, 0 to 1. It is 1 exactly if the state is held.
  double progress() const noexcept { return progress_; }
  /// Returns the held pose; meaningful only if the state is held.
  const HeldPose& held() const noexcept { return held_; }
  /// Begins to wait for a pose that differs from the held one.
  void begin_next() noexcept;
  /// Lets the next capture accept the last held pose again.
  void forget_last() noexcept { last_ = {}; }
  /// Sets the last held pose, from an earlier capture.
  void set_last(const HeldPose& pose) noexcept { last_ = pose; }

private:
  struct Watched {
    double before_counts = 0.0; ///< the previous sample
    double earlier_counts = 0.0;
    double noise_variance = 0.0; ///< from second differences, which cancel steady movement
    double low_counts = 0.0;     ///< since the window began, as all fields below
    double high_counts = 0.0;
    double mean_counts = 0.0;
    double squares = 0.0; ///< sum of squared deviations from the mean
    std::uint32_t at_end = 0;
  };
  void begin_window(const GloveSample& sample, HostTime now) noexcept;
  void watch_noise(const GloveSample& sample, double elapsed_s) noexcept;
  void add(const GloveSample& sample) noexcept;
  CaptureState state_in_movement(SensorMask moved) noexcept;
  CaptureState state_at_rest(double still_s) noexcept;
  SensorMask restless() const noexcept;
  SensorMask at_ends() const noexcept;
  bool differs_from_last() const noexcept;
  void fill_held() noexcept;

  CountScale scale_;
  double unit_; ///< counts of this scale per count of 255
  std::array<Watched, sensor_slots> watched_{};
  SensorMask present_;
  HostTime begun_{};
  HostTime last_time_{};
  std::uint32_t samples_ = 0; ///< in the window
  std::uint32_t seen_ = 0;    ///< since the sensors last changed; stops at 3
  CaptureState state_ = CaptureState::waiting;
  SensorMask troubled_;
  SensorMask last_troubled_; ///< at the previous sample
  double progress_ = 0.0;
  HeldPose held_{};
  HeldPose last_{};
};

} // namespace nendo::hand
