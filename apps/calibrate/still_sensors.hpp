#pragma once
// Finds stuck sensors while a wearer is guided. The guide knows more than hand::StuckWatch: it has
// asked for a motion of every joint, and for poses that bend a joint by different angles.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/hand/calibration_fit.hpp>
#include <nendo/hand/stuck_watch.hpp>

namespace nendo::calibrate {

class StillSensors {
public:
  explicit StillSensors(CountScale scale) : scale_(scale), watch_(scale) {}

  /// Takes the next sample in time. One of the same time as the last is passed over.
  void push(const GloveSample& sample);
  void captured(hand::PoseId pose) { poses_.push_back(pose); }

  /// Returns the sensors that are stuck by all that was seen so far: they have not changed while
  /// others swung (hand::StuckWatch), or over poses that ask for different angles, or since the
  /// beginning at an end of their counts.
  SensorMask stuck() const;
  /// Returns whether a sensor, which makes a held pose implausible, has not changed over the poses
  /// before it, though this one asks for another angle.
  bool contradicts(Sensor sensor, hand::PoseId pose) const;
  /// Returns those that have not changed since the beginning, while the hand went through a free
  /// motion of all joints. Without such a motion there are none.
  SensorMask still_in_free_motion() const;

private:
  struct Seen {
    std::uint16_t least = 0, most = 0; ///< since the beginning
    std::uint16_t low = 0, high = 0;   ///< since it last changed
    std::size_t changed_after = 0;     ///< so many poses were held before it last changed
    bool changed = false;              ///< ever
  };
  std::span<const hand::PoseId> poses_since_change(std::size_t slot) const;
  bool others_moved(std::size_t slot, double counts, int part) const;

  CountScale scale_;
  hand::StuckWatch watch_;
  std::array<Seen, sensor_slots> seen_{};
  SensorMask present_;
  std::optional<HostTime> begun_;
  HostTime last_{};
  std::vector<hand::PoseId> poses_;
};

/// Returns the sensors that show the same count in all held poses, though these ask for different
/// angles.
SensorMask still_in(const std::vector<hand::PoseReading>& readings, CountScale scale);

} // namespace nendo::calibrate
