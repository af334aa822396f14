#pragma once
// Everything that determines a touching hand's motion, computed beforehand.

#include <array>
#include <vector>

#include "motions/touching_hand.hpp"
#include <nendo/hand/angle.hpp>

#include "motions/surface_walk.hpp"
#include "motions/touch_score.hpp"

namespace nendo::motions {

/// The part of one finger.
struct TouchingFinger {
  bool touches = false;
  double press_m = 0.0;            ///< where the score says 1
  double pull_m = 0.0;             ///< where it says -1
  double glide = 1.0;              ///< how much of its way it goes
  std::vector<SurfacePoint> way{}; ///< evenly, and so fine that what is between them is straight

  TouchTarget target(double depth, double way_part) const noexcept;
};

struct TouchPlan {
  /// The angles of the joints, by index_of(Angle).
  using Row = std::array<double, hand::angle_count>;

  TouchScore score;
  Eigen::Isometry3d T_stage_wrist = Eigen::Isometry3d::Identity();
  std::array<TouchingFinger, hand::finger_count> fingers{};
  std::vector<Row> keys{}; ///< evenly over the score's period

  TouchTarget target(hand::Finger finger, double time_s) const noexcept {
    const TouchingFinger& own = fingers[static_cast<std::size_t>(finger)];
    return own.target(score.depth(finger, time_s), score.way(time_s));
  }
};

/// Computes the plan. Errors and cost are those of TouchingHand::make().
Result<TouchPlan> plan_touch(const deform::Mesh& model, const hand::HandSkeleton& skeleton,
                             const TouchOptions& options);

} // namespace nendo::motions
