#pragma once
// Simulated hands that work on clay or carry parts: their wrists move, and their fingers bend, by a
// plan for the model before them.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/flow/wrist.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::motions {

/// What a hand does. A left hand helps the right one, and can do it alone.
enum class KneadTask : std::uint8_t {
  press, ///< flattens the model on its table with the palm, turned from press to press; by turns
  knead, ///< thumbs it into a bowl; left: holds the wall from outside
  grip,  ///< pinches it with thumb and index finger, and pulls an ear; left: on the other side
  carry, ///< takes its upper part by the side, lifts it, turns it round, and presses it on again
  bore,  ///< goes down through its middle to the table with the thumb; by turns
  cut,   ///< draws a wire through it, below the upper part, from 0.8 s to 2.5 s, and then does that
  slice, ///< the same with a knife, which one hand draws alone
};
inline constexpr std::array knead_tasks{KneadTask::press, KneadTask::knead, KneadTask::grip,
                                        KneadTask::carry, KneadTask::bore,  KneadTask::cut,
                                        KneadTask::slice};
std::string_view name_of(KneadTask task) noexcept;

/// The motion: it begins and ends beside the model, and the hand then stays there.
class KneadingHand {
public:
  /// Plans the motion. The model's longest side is `model_size_m` on the stage. Error: bad_input,
  /// if the model has no size. The same arguments give the same motion. Allocates.
  static Result<KneadingHand> make(const deform::Mesh& model, const hand::HandSkeleton& skeleton,
                                   KneadTask task, double model_size_m);

  /// Returns the joint angles at a time since the start; times before it, and such as are not
  /// finite, count as 0. Any thread, wait-free.
  hand::JointAngles angles(double time_s) const noexcept;
  /// Returns the sensors' angles of a glove at that time; joint_angles() turns them into
  /// angles(time_s).
  hand::SensorAngles sensor_angles(double time_s) const noexcept;
  const std::shared_ptr<const flow::WristPath>& wrist() const noexcept { return wrist_; }
  double length_s() const noexcept { return wrist_->length_s(); }

private:
  KneadingHand() = default;

  std::shared_ptr<const std::vector<hand::JointAngles>> keys_;
  std::shared_ptr<const flow::WristPath> wrist_;
};

/// The model on the stage, in metres.
struct KneadedModel {
  static constexpr double upper = 0.85; ///< where hands take its upper part, relative to its height
  static constexpr double neck_at = 0.57; ///< where it is cut, relative to its height

  Eigen::Vector3d low, high;   ///< corners of its box
  double upper_radius_m = 0.0; ///< how far it reaches to its sides there
  Eigen::Vector3d neck;        ///< the middle of the cut; there its upper part is turned

  /// Of one of several models side by side: where its upper part reaches the farthest to the hand's
  /// side. All else is that model's.
  std::optional<Eigen::Vector3d> taken_at{};

  Eigen::Vector3d middle() const { return 0.5 * (low + high); }
  double height() const { return high.y() - low.y(); }
  double radius() const { return 0.25 * (high.x() - low.x() + high.z() - low.z()); }
};

class KneadPlan {
public:
  struct Pose {
    hand::JointAngles angles;
    Eigen::Isometry3d T_stage_wrist = Eigen::Isometry3d::Identity();
  };

  virtual ~KneadPlan() = default;
  virtual double length_s() const noexcept = 0;
  /// Returns the pose at a time from 0 to length_s().
  virtual Pose at(double time_s) const noexcept = 0;
};

std::unique_ptr<KneadPlan> plan_of(KneadTask task, const KneadedModel& model,
                                   const hand::HandSkeleton& skeleton);

inline constexpr double away_m = 0.05;       ///< from the model, where a motion begins and ends
inline constexpr double pinch_gap_m = 0.011; ///< between the tips of thumb and index finger

double ease(double time_s, double begin_s, double end_s) noexcept;
/// Returns a wrist's axes, with the fingers along `fingers` and the back of the hand towards
/// `back`.
Eigen::Matrix3d axes_of(const Eigen::Vector3d& fingers, const Eigen::Vector3d& back) noexcept;
hand::JointAngles flat_hand() noexcept;
/// Bent fingers that are out of the way of a thumb or of a pinch.
hand::JointAngles fist() noexcept;

/// Interpolates between two hands' angles: 0 is `from`, and 1 is `to`.
hand::JointAngles blended(const hand::JointAngles& from, const hand::JointAngles& to,
                          double part) noexcept;

/// Thumb and index finger at a side of the model, from above.
class PinchingFingers {
public:
  PinchingFingers(const hand::HandSkeleton& skeleton, double open_gap_m, double closed_gap_m);

  Eigen::Vector3d outwards() const noexcept { return stage_.col(0); }
  /// With the middle between the tips there, and fingers that are closed by so much, 0 to 1.
  KneadPlan::Pose at(const Eigen::Vector3d& tips, double closed) const noexcept;

private:
  Eigen::Isometry3d wrist_at(const Eigen::Vector3d& tips) const noexcept;
  hand::JointAngles pinched(const hand::HandSkeleton& skeleton, const hand::JointAngles& start,
                            double gap_m) const;

  hand::JointAngles open_, closed_;
  Eigen::Matrix3d stage_; ///< outwards, from the thumb to the index finger, across; left: mirrored
};

} // namespace nendo::motions
