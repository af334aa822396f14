#pragma once
// The guided calibration without its terminal. It knows which pose is asked for and which poses
// were held, and checks whether a held pose can be the one asked for.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/hand/calibration_fit.hpp>
#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/pose_capture.hpp>
#include <nendo/hand/range_capture.hpp>

#include "calibrate/still_sensors.hpp"

namespace nendo::calibrate {

class CalibrationGuide {
public:
  /// `poses` are in the order in which they are asked for; a pose that is in it twice is taken
  /// twice. They must contain flat and fist. By sensors of `stiff` joints no pose is refused.
  CalibrationGuide(std::span<const hand::PoseId> poses, CountScale scale, SensorMask stiff = {});

  enum class Event : std::uint8_t {
    none,
    captured,    ///< the pose was held and is kept; the next one is asked for
    implausible, ///< a pose was held that cannot be the one asked for; see implausible_sensor()
  };
  /// Takes a sample of the free motion that comes before the poses.
  void push_free_motion(const GloveSample& sample);
  /// Leaves out the sensors that did not change in the free motion, if it was one. Call it once,
  /// when the poses begin.
  void end_free_motion();
  hand::CountRanges free_motion() const noexcept;

  /// Takes the next sample in time. Does nothing once is_done().
  Event push(const GloveSample& sample);

  /// Returns the sensors that are left out, because they were found stuck, or by leave_out(). No
  /// pose, and no free motion, has them.
  SensorMask left_out() const noexcept { return left_out_; }
  void leave_out(SensorMask sensors) noexcept { left_out_.bits |= sensors.bits; }

  bool is_done() const noexcept { return at_ == poses_.size(); }
  /// Returns the pose asked for. Must not be called once is_done().
  hand::PoseId asked() const noexcept { return poses_[at_]; }
  std::size_t number() const noexcept { return at_; } ///< index of the pose asked for
  std::size_t pose_count() const noexcept { return poses_.size(); }
  const hand::PoseCapture& capture() const noexcept { return capture_; }
  /// Returns the sensor that makes the last held pose implausible, or nullopt.
  std::optional<Sensor> implausible_sensor() const noexcept { return implausible_; }

  /// Returns the pose of a number below pose_count(), and whether it is kept.
  hand::PoseId pose(std::size_t number) const noexcept { return poses_[number]; }
  bool is_kept(std::size_t number) const noexcept { return kept_[number].has_value(); }

  /// Returns whether the pose asked for was taken before and is taken again.
  bool is_again() const noexcept;

  void ask_for(std::size_t number); ///< forgets the pose of that number and asks for it
  void go_back();                   ///< forgets the pose before this one and asks for it again
  void take_again(); ///< asks for the pose before this one once more; both takes count
  void skip();       ///< continues without this pose; flat and fist are asked for again at the end
  void reset();      ///< forgets all poses and the free motion, and asks for the first pose
  /// Restores what an earlier session kept. Poses that are not asked for here are left out, and so
  /// are takes of a pose beyond `max_takes`. The last pose restored counts as held last.
  void restore(std::span<const hand::PoseReading> readings, const hand::CountRanges& free_motion);
  static constexpr std::size_t max_takes = 8;

  /// Returns the held poses in the order in which they are asked for, without what is left out.
  std::vector<hand::PoseReading> readings() const;
  bool has_any() const noexcept;

private:
  /// Except sensors of stiff joints, which may not move.
  void leave_out_stuck(SensorMask stuck) noexcept { leave_out({stuck.bits & ~stiff_.bits}); }
  void advance();
  void ask_again() noexcept;
  std::ptrdiff_t last_kept() const noexcept;
  std::optional<Sensor> find_implausible(const hand::HeldPose& held) const;
  std::optional<Sensor> find_unbent(const hand::HeldPose& held) const;
  const hand::HeldPose* kept(hand::PoseId pose) const;

  CountScale scale_;
  SensorMask stiff_;
  std::vector<hand::PoseId> planned_;               ///< as they were given
  std::vector<hand::PoseId> poses_;                 ///< those, and what is taken once more
  std::vector<std::optional<hand::HeldPose>> kept_; ///< indexed as poses_
  std::size_t at_ = 0;
  hand::PoseCapture capture_;
  bool same_may_come_ = false; ///< the last pose counts again once the hand has moved
  hand::RangeCapture free_motion_;
  std::optional<Sensor> implausible_;
  StillSensors still_;
  SensorMask left_out_;
};

} // namespace nendo::calibrate
