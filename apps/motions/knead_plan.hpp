#pragma once
// The motion of a kneading hand: its wrist's pose and its fingers' angles over time.

#include <memory>
#include <optional>

#include "motions/kneading_hand.hpp"

namespace nendo::motions {

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
  /// Half of its mean breadth.
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

} // namespace nendo::motions
