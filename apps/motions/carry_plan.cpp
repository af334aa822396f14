#include "motions/carry_plan.hpp"

#include <algorithm>
#include <numbers>

#include "motions/plan_hands.hpp"

namespace nendo::motions {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using hand::JointAngles;

/// Takes the upper part by the side, lifts it, turns it half-way round, presses it on, and leaves.
/// One of several models is lifted over to the side instead, and put down there.
class Carry final : public KneadPlan {
public:
  Carry(const KneadedModel& model, const hand::HandSkeleton& skeleton)
      : model_(model), fingers_(skeleton, open_gap_m, pinch_gap_m) {
    taken_at_ = model.middle();
    taken_at_.y() = model.low.y() + KneadedModel::upper * model.height();
    const double side = fingers_.outwards().x() > 0.0 ? 1.0 : -1.0;
    taken_at_.x() += side * std::max(0.0, model.upper_radius_m - into_m);
    if (!model.taken_at) return;
    const double breadth = model.high.x() - model.low.x();
    taken_at_ = *model.taken_at - side * std::min(into_m, 0.15 * breadth) * Vector3d::UnitX();
    aside_ = side * aside * breadth * Vector3d::UnitX();
  }

  double length_s() const noexcept override { return 8.6; }

  Pose at(double time_s) const noexcept override {
    const double closed = ease(time_s, 1.0, 1.6) - ease(time_s, 7.0, 7.4);
    const double out = 2.0 * away_m * (1.0 - ease(time_s, 0.0, 0.9) + ease(time_s, 7.4, 8.6));
    Pose pose = fingers_.at(taken_at_ + out * fingers_.outwards(), closed);
    pose.T_stage_wrist = motion_at(time_s) * pose.T_stage_wrist;
    return pose;
  }

private:
  /// Of the part: about the vertical line through the neck's middle, where the faces of a cut then
  /// lie on each other the best.
  Isometry3d motion_at(double time_s) const noexcept {
    if (model_.taken_at) {
      const double up = lift * model_.height() * (ease(time_s, 1.8, 3.0) - ease(time_s, 5.4, 6.8));
      return Isometry3d(
          Eigen::Translation3d(ease(time_s, 2.4, 6.0) * aside_ + up * Vector3d::UnitY()));
    }
    const double turned = std::numbers::pi * ease(time_s, 2.8, 5.4);
    const double lifted = lift * model_.height() * ease(time_s, 1.8, 3.0) -
                          (lift + press) * model_.height() * ease(time_s, 5.4, 6.8);
    Isometry3d motion = Isometry3d::Identity();
    motion.linear() = Eigen::AngleAxisd(turned, Vector3d::UnitY()).matrix();
    motion.translation() = model_.neck - motion.linear() * model_.neck + lifted * Vector3d::UnitY();
    return motion;
  }

  static constexpr double open_gap_m = 0.055; ///< wide enough to have released
  static constexpr double into_m = 0.012;     ///< the model, from its side
  static constexpr double lift = 0.5;         ///< of the model's height
  static constexpr double press = 0.02;       ///< likewise: deeper than it was
  static constexpr double aside = 0.7;        ///< of its breadth

  KneadedModel model_;
  PinchingFingers fingers_;
  Vector3d taken_at_;
  Vector3d aside_ = Vector3d::Zero();
};

/// The index finger leads a wire's end, or a knife, through the model from the front. Then the
/// upper part is carried.
class CutAndCarry final : public KneadPlan {
public:
  CutAndCarry(CutTool tool, const KneadedModel& model, const hand::HandSkeleton& skeleton)
      : model_(model), carry_(model, skeleton), angles_(fist()),
        side_(skeleton.side() == Side::right ? 1.0 : -1.0) {
    fingers_ =
        tool == CutTool::wire ? Vector3d(-Vector3d::UnitZ()) : Vector3d(-side_ * Vector3d::UnitX());
    angles_.fingers[0] = {};
    tip_m_ = skeleton.pose(angles_, Isometry3d::Identity())[hand::Joint::index_tip].translation();
  }

  double length_s() const noexcept override { return carry_from_s + carry_.length_s(); }

  Pose at(double time_s) const noexcept override {
    if (time_s >= carry_from_s) return carry_.at(time_s - carry_from_s);
    Pose cuts = cutting_at(time_s);
    const double part = ease(time_s, 2.7, carry_from_s);
    if (part <= 0.0) return cuts;
    const Pose carries = carry_.at(0.0);
    return {blended(cuts.angles, carries.angles, part),
            flow::blended(cuts.T_stage_wrist, carries.T_stage_wrist, part)};
  }

private:
  Pose cutting_at(double time_s) const noexcept {
    Vector3d tip = model_.middle();
    tip.x() += side_ * (0.5 * (model_.high.x() - model_.low.x()) + beside_m);
    tip.y() = model_.neck.y();
    tip.z() = model_.high.z() + away_m -
              ease(time_s, 0.6, 2.6) * (model_.high.z() - model_.low.z() + 2.0 * away_m);
    Pose pose{angles_, Isometry3d::Identity()};
    pose.T_stage_wrist.linear() = axes_of(fingers_, Vector3d::UnitY());
    pose.T_stage_wrist.translation() = tip - pose.T_stage_wrist.linear() * tip_m_;
    return pose;
  }

  static constexpr double carry_from_s = 4.2;
  static constexpr double beside_m = 0.030; ///< from the model's box

  KneadedModel model_;
  Carry carry_;
  JointAngles angles_;
  double side_;      ///< of x
  Vector3d fingers_; ///< where they point to while it cuts
  Vector3d tip_m_;
};

} // namespace

std::unique_ptr<KneadPlan> plan_to_carry(const KneadedModel& model,
                                         const hand::HandSkeleton& skeleton) {
  return std::make_unique<Carry>(model, skeleton);
}

std::unique_ptr<KneadPlan> plan_to_cut(CutTool tool, const KneadedModel& model,
                                       const hand::HandSkeleton& skeleton) {
  return std::make_unique<CutAndCarry>(tool, model, skeleton);
}

} // namespace nendo::motions
