#pragma once
// Finds sensors that do not change although their joints move. A joint at rest also gives a
// constant count. A sensor is therefore stuck only if its neighbours move to and fro for long,
// which no hand does without moving this joint by a count. Nothing is found in a hand at rest, and
// a finger that moves alone proves nothing about the others.

#include <array>
#include <cstdint>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/swing_finder.hpp>

namespace nendo::hand {

/// Watches the samples of a glove. The result depends on them alone, so that a replay gives the
/// same result. Wait-free, no allocation.
class NENDO_API StuckWatch {
public:
  static constexpr double min_still_s = 3.0;       ///< minimum constant time of a stuck sensor
  static constexpr double min_swing_counts = 16.0; ///< counts of 255: about 11 degrees

  /// `stuck` are the sensors that an earlier watch of the same glove found.
  explicit StuckWatch(CountScale scale = {}, SensorMask stuck = {}) noexcept;

  /// Takes samples in time order. A change of hand or sensors restarts the watch.
  void push(const GloveSample& sample) noexcept;

  /// Returns the stuck sensors. A sensor that moves again is soon removed.
  SensorMask stuck() const noexcept { return stuck_; }
  Side side() const noexcept { return side_; }

private:
  static constexpr std::size_t kept_swings = 8;
  struct Watched {
    SwingFinder swings{};
    /// The numbers of the samples at which its last swings ended, the oldest at `next`.
    std::array<std::uint64_t, kept_swings> ended{};
    std::size_t next = 0;
    std::uint16_t low = 0, high = 0; ///< since it last changed
    std::uint64_t changed = 0;       ///< the number of the sample that changed it
    HostTime changed_at{};
    std::uint8_t away = 0; ///< successive samples with movement of a stuck sensor
  };

  void reset(const GloveSample& sample) noexcept;
  void watch(std::size_t slot, const GloveSample& sample) noexcept;
  bool has_swung(std::size_t slot, std::uint64_t since, std::size_t times) const noexcept;
  template <class Sensors>
  int swung(const Sensors& sensors, std::size_t of, std::size_t times) const noexcept;
  bool is_shown(std::size_t slot, const GloveSample& sample) const noexcept;
  bool shown_by_finger(std::size_t slot) const noexcept;
  bool shown_by_thumb(std::size_t slot) const noexcept;
  bool shown_by_hand(std::size_t slot, std::size_t times, int part) const noexcept;

  CountScale scale_;
  std::array<Watched, sensor_slots> watched_{};
  SensorMask present_;
  SensorMask stuck_;
  SensorMask first_stuck_; ///< stuck sensors at the first sample
  Side side_ = Side::right;
  std::uint64_t number_ = 0; ///< number of the sample
};

/// Returns whether a count is at an end of an A/D converter's range, as usual for a broken sensor.
/// False for self-calibrating gloves, which are at an end whenever a joint is.
constexpr bool is_at_end(std::uint16_t count, CountScale scale) noexcept {
  return !scale.self_calibrated && (count <= 1 || count + 1 >= scale.max_count);
}

/// Returns whether counts from `low` to `high` are only flicker: of a twelve-bit converter's last
/// two bits, or of the last bit at an end.
constexpr bool is_still(std::uint16_t low, std::uint16_t high, CountScale scale) noexcept {
  const bool same_end = high - low <= 1 && is_at_end(low, scale) && is_at_end(high, scale);
  return high - low <= scale.max_count / 1024 || same_end;
}

/// Returns whether counts reach an end of a self-calibrating glove's scale, to which it clamps
/// straight or fully bent joints: a constant count there means nothing.
constexpr bool rests_at_end(double low, double high, CountScale scale) noexcept {
  return scale.self_calibrated && (low <= 0.0 || high >= scale.max_count);
}

} // namespace nendo::hand
