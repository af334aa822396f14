#pragma once
// A simulated hand that touches the model. Its fingertips lie on the model's surface, press into it
// and pull at it by stated depths, one finger after another and all together, and glide along it
// between the strokes. The joint angles are computed from the places of the tips by inverse
// kinematics.

#include <cstdint>
#include <memory>
#include <utility>

#include <nendo/base/result.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::motions {

/// The depths are upper bounds: a finger that cannot reach so far goes as far as it can.
struct TouchOptions {
  std::uint32_t seed = 1; ///< determines the order of fingers, the tempo and the glides
  static constexpr double press_m = 0.020;
  static constexpr double pull_m = 0.090;
  static constexpr double glide_m = 0.012;
  double model_size_m = flow::PlacementOptions{}.model_size_m;
};

struct TouchTarget {
  Eigen::Vector3d contact_m = Eigen::Vector3d::Zero(); ///< on the surface, as it is undeformed
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< the surface's normal there, outwards
  double depth_m = 0.0; ///< > 0: pressed in along the normal, < 0: pulled out

  Eigen::Vector3d place_m() const { return contact_m - depth_m * normal; }
};

struct TouchPlan;

/// The motion: one stroke after another. After period_s() everything is repeated. At time 0 all
/// fingertips lie on the surface.
class TouchingHand {
public:
  /// How far a fingertip may be from its target, at any time.
  static constexpr double tolerance_m = 1e-4;

  /// Computes the motion. The model and the hand are placed by place_hands(). Error: bad_input, if
  /// the model has no faces or none within reach. Allocates, and takes about 0.1 s, or longer with
  /// millions of faces.
  static Result<TouchingHand> make(const deform::Mesh& model, const hand::HandSkeleton& skeleton,
                                   const TouchOptions& options = {});

  /// Returns the joint angles at `time_s` since the start; negative times and times that are not
  /// finite count as 0. They are continuously differentiable, and within the ranges in which
  /// joint_angles() leaves angles as they are. The middle finger does not turn aside, because no
  /// glove measures that. Any thread, wait-free.
  hand::JointAngles angles(double time_s) const noexcept;
  /// Returns the sensors' angles of a glove at that time; joint_angles() turns them into
  /// angles(time_s).
  hand::SensorAngles sensor_angles(double time_s) const noexcept;
  /// Returns a finger's target at that time; zeros for a finger that keeps still because it cannot
  /// reach the surface. Any thread.
  TouchTarget target(hand::Finger finger, double time_s) const noexcept;

  bool touches(hand::Finger finger) const noexcept;
  /// Returns T_stage_wrist, the place where the forearm ends.
  const Eigen::Isometry3d& wrist_pose() const noexcept;
  double period_s() const noexcept;

private:
  explicit TouchingHand(std::shared_ptr<const TouchPlan> plan) : plan_(std::move(plan)) {}

  std::shared_ptr<const TouchPlan> plan_;
};

} // namespace nendo::motions
