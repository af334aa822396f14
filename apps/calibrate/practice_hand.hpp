#pragma once
// A simulated wearer who does what nendo calibrate asks for: a free motion of all joints, then each
// pose, held. The hand is a stranger's: of another size, in a glove whose sensors bend otherwise,
// and no pose is held exactly. So anybody can practise a calibration without a glove.

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/calibration_poses.hpp>

namespace nendo::calibrate {

/// One thread may ask for angles while another one says when to continue.
class PracticeHand {
public:
  static constexpr double free_motion_s = 8.0; ///< with hold_s: how long the free motion is
  static constexpr double turn_s = 0.6;        ///< from one pose to the next

  /// `hold_s`: each pose is left after so long, and after the last one all begins again, so that a
  /// wearer who missed a pose can begin again as well; nothing: only go_on() leaves it. Takes a
  /// moment, because tips that touch are brought together.
  PracticeHand(std::uint32_t seed, std::optional<double> hold_s);

  /// Returns the sensors' angles as the stranger's glove has them, for a typical one's gains.
  /// `time_s` must not fall.
  hand::SensorAngles at(double time_s);

  /// Continues to the next pose, or back to the previous one. Any thread.
  void go_on() noexcept {
    if (shown_ <= pose_count()) ++asked_;
  }
  void go_back() noexcept {
    if (shown_ > 0) --asked_;
  }
  /// Returns how far it is: 0 is the free motion, k the pose k; one more than the poses: the end.
  /// Any thread.
  int step() const noexcept { return shown_.load(); }
  int pose_count() const noexcept { return static_cast<int>(poses_.size()); }
  /// Returns what a step is, in words: "pose 3 of 34: spread".
  std::string in_words(int step) const;

private:
  void keep_from_ends();
  hand::SensorAngles free_motion(double time_s) const;
  int wanted(double time_s) noexcept;

  std::optional<double> hold_s_;
  std::mt19937 random_;
  std::vector<hand::PoseId> ids_;
  std::vector<hand::SensorAngles> poses_;
  std::array<double, sensor_slots> gains_{}; ///< the glove's, as parts of a typical one's
  std::array<double, sensor_slots> offsets_rad_{};
  std::atomic<int> asked_{0}; ///< steps that go_on() and go_back() make
  std::atomic<int> shown_{0};
  double turned_s_ = 0.0;     ///< when it went to this step
  hand::SensorAngles from_{}; ///< where it went from
  hand::SensorAngles now_{};
};

} // namespace nendo::calibrate
