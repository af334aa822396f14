#include "motions/kneading_hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <nendo/hand/hand_body.hpp>

namespace nendo::motions {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using hand::JointAngles;

/// The lowest place of a flat hand, below the wrist's axis.
double palm_depth_m(const hand::HandSkeleton& skeleton, const JointAngles& angles) {
  hand::HandBody body(skeleton);
  body.follow(skeleton.pose(angles, Isometry3d::Identity()));
  double lowest = 0.0;
  for (const hand::BodyPart& part : body.parts())
    for (std::size_t corner = 0; corner < part.corner_count; ++corner)
      lowest = std::min(lowest, part.corners_m[corner].y() - part.radii_m[corner]);
  return -lowest;
}

/// A hand whose palm comes along `way`, with the palm's middle on the line through `at`.
class Palm {
public:
  explicit Palm(const hand::HandSkeleton& skeleton)
      : angles_(flat_hand()), depth_m_(palm_depth_m(skeleton, angles_)),
        middle_m_(0.42 * skeleton.rest_offset(hand::Joint::middle_metacarpal).norm() + 0.075) {}

  const JointAngles& angles() const noexcept { return angles_; }
  /// The palm's surface touches `at`, which it faces against `back`.
  Isometry3d wrist(const Vector3d& at, const Vector3d& fingers, const Vector3d& back) const {
    Isometry3d T = Isometry3d::Identity();
    T.linear() = axes_of(fingers, back);
    T.translation() = at + depth_m_ * T.linear().col(1) + middle_m_ * T.linear().col(2);
    return T;
  }

private:
  JointAngles angles_;
  double depth_m_;
  double middle_m_; ///< from the wrist to what presses most
};

/// Presses flat on the table, from above. Two hands take turns, each from its own side.
class Flatten final : public KneadPlan {
public:
  Flatten(const KneadedModel& model, const hand::HandSkeleton& skeleton)
      : model_(model), palm_(skeleton), side_(skeleton.side() == Side::right ? 1.0 : -1.0) {}

  double length_s() const noexcept override {
    return turn_s * (static_cast<double>(presses) + 0.5);
  }

  Pose at(double time_s) const noexcept override {
    const double begin_s = side_ > 0.0 ? 0.0 : 0.5 * turn_s;
    const double own_s = std::max(0.0, time_s - begin_s);
    const double number = std::min(std::floor(own_s / turn_s), presses - 1.0);
    const auto press = static_cast<std::size_t>(number);
    const double t = own_s - turn_s * number;
    const std::size_t of_both = 2 * press + (side_ > 0.0 ? 0 : 1);
    const double top = of_both == 0 ? 1.0 : thickness[of_both - 1];
    const double down = top + (thickness[of_both] - top) * ease(t, 0.4, 0.8);
    const double lifted = lift_m * (1.0 - ease(t, 0.1, 0.45) + ease(t, 0.9, 1.25));
    const double aside = aside_m * (1.0 - ease(t, 0.0, 0.35) + ease(t, 0.95, 1.35));
    const double next = press + 1 < presses ? turn_deg[press + 1] : turn_deg[press];
    const double turn_rad =
        side_ * from_degrees(turn_deg[press] + (next - turn_deg[press]) * ease(t, 1.3, turn_s));
    Vector3d at = model_.middle() + side_ * aside * Vector3d::UnitX();
    at.y() = model_.low.y() + down * model_.height() + lifted;
    const Vector3d fingers(-std::sin(turn_rad), 0.0, -std::cos(turn_rad));
    return {palm_.angles(), palm_.wrist(at, fingers, Vector3d::UnitY())};
  }

private:
  static constexpr double turn_s = 1.8;   ///< from one press to the same hand's next
  static constexpr double lift_m = 0.09;  ///< between presses
  static constexpr double aside_m = 0.11; ///< then, where it leaves space for the other hand
  static constexpr std::size_t presses = 5;
  static constexpr std::array<double, presses> turn_deg{25.0, 75.0, -5.0, 50.0, 10.0};
  /// Of the model's height, after each press of both hands.
  static constexpr std::array<double, 2 * presses> thickness{0.72, 0.60, 0.50, 0.43, 0.38,
                                                             0.36, 0.35, 0.34, 0.34, 0.34};

  KneadedModel model_;
  Palm palm_;
  double side_; ///< 1: right
};

/// The rounds of a bowl: presses outwards, side by side.
struct BowlRounds {
  static constexpr double enter_s = 1.6, press_s = 0.42, leave_s = 1.0;
  static constexpr std::size_t presses = 10, rounds = 3;
  static constexpr double all_s = press_s * presses * rounds;
  static constexpr std::array<double, rounds> out{0.25, 0.42, 0.56};  ///< relative to the radius
  static constexpr std::array<double, rounds> wall{1.12, 1.17, 1.22}; ///< where it is held
  static constexpr std::array<double, rounds> lean_rad{0.05, 0.1,
                                                       0.15}; ///< how far the thumb leans

  std::size_t round = 0;
  double angle_rad = 0.0; ///< the press's angle about the axis
  double going_rad = 0.0; ///< the same, but on its way from one press to the next
  double part = 0.0;      ///< the fraction of the press, from 0 to 1
  bool is_pressing = false;

  static BowlRounds at(double time_s) noexcept {
    const double gone = (time_s - enter_s) / press_s;
    const double most = static_cast<double>(presses * rounds);
    BowlRounds now;
    now.is_pressing = gone >= 0.0 && gone < most;
    const double within = std::clamp(gone, 0.0, most);
    const double whole = std::min(std::floor(within), most - 1.0);
    now.round = static_cast<std::size_t>(whole) / presses;
    now.part = now.is_pressing ? gone - whole : 0.0;
    now.angle_rad = angle_of(whole);
    const double part = within - whole;
    const double on = ease(part, 0.7, 1.3);          // to the next, half of the way
    const double back = 1.0 - ease(part, -0.3, 0.3); // from the one before
    now.going_rad = now.angle_rad + on * (angle_of(whole + 1.0) - now.angle_rad) -
                    back * (now.angle_rad - angle_of(whole - 1.0));
    return now;
  }
  static constexpr double length_s() noexcept { return enter_s + all_s + leave_s; }
  Vector3d outwards() const noexcept { return along(angle_rad); }
  static Vector3d along(double angle) noexcept { return {std::cos(angle), 0.0, -std::sin(angle)}; }

private:
  /// Each round begins half a step beside the previous one.
  static double angle_of(double press) noexcept {
    const double round = std::max(0.0, std::floor(press / static_cast<double>(presses)));
    return 2.0 * std::numbers::pi * (press + 0.5 * round) / static_cast<double>(presses);
  }
};

/// A fist whose thumb points down.
class PointingThumb {
public:
  explicit PointingThumb(const hand::HandSkeleton& skeleton) : angles_(fist()) {
    angles_.thumb_abduction_rad = from_degrees(50); // 65 mm of it are free of the fist
    const hand::HandPose pose = skeleton.pose(angles_, Isometry3d::Identity());
    tip_m_ = pose[hand::Joint::thumb_tip].translation();
    along_ = (tip_m_ - pose[hand::Joint::thumb_proximal].translation()).normalized();
    const Vector3d knuckle = pose[hand::Joint::index_proximal].translation();
    aside_ = (knuckle - tip_m_) - (knuckle - tip_m_).dot(along_) * along_;
    aside_.normalize();
  }

  KneadPlan::Pose at(const Vector3d& tip, const Vector3d& down) const noexcept {
    KneadPlan::Pose pose{angles_, Isometry3d::Identity()};
    pose.T_stage_wrist.linear() = turn_to(down);
    pose.T_stage_wrist.translation() = tip - pose.T_stage_wrist.linear() * tip_m_;
    return pose;
  }

private:
  /// The thumb points down, and the knuckles to the operator's right and towards the operator.
  Matrix3d turn_to(const Vector3d& down) const noexcept {
    const auto frame = [](const Vector3d& x, const Vector3d& y) {
      Matrix3d axes;
      axes.col(0) = x;
      axes.col(1) = (y - y.dot(x) * x).normalized();
      axes.col(2) = axes.col(0).cross(axes.col(1));
      return axes;
    };
    return frame(down, Vector3d(1.0, 0.0, 0.6)) * frame(along_, aside_).transpose();
  }

  JointAngles angles_;
  Vector3d tip_m_, along_, aside_; ///< in the wrist's frame
};

/// The thumb goes down the middle, and then presses outwards all around.
class Thumb final : public KneadPlan {
public:
  Thumb(const KneadedModel& model, const hand::HandSkeleton& skeleton)
      : model_(model), thumb_(skeleton) {}

  double length_s() const noexcept override { return BowlRounds::length_s(); }

  Pose at(double time_s) const noexcept override {
    const BowlRounds now = BowlRounds::at(time_s);
    const double end_s = BowlRounds::enter_s + BowlRounds::all_s;
    const double out = now.is_pressing ? BowlRounds::out[now.round] * ease(now.part, 0.0, 0.4) *
                                             (1.0 - ease(now.part, 0.65, 1.0))
                                       : 0.0;
    const double lift = 1.0 - ease(time_s, 0.0, BowlRounds::enter_s) +
                        ease(time_s, end_s, end_s + BowlRounds::leave_s);
    const double deep = model_.low.y() + floor * model_.height();
    const double above = model_.high.y() + away_m;
    Vector3d tip = model_.middle() + out * model_.radius() * now.outwards();
    tip.y() = deep + lift * (above - deep);
    const double lean =
        out > 0.0 ? BowlRounds::lean_rad[now.round] * std::min(1.0, 4.0 * out) : 0.0;
    return thumb_.at(tip, (-lean * now.outwards() - Vector3d::UnitY()).normalized());
  }

private:
  static constexpr double floor =
      0.30; ///< the thumb's tip over the model's foot, relative to the height

  KneadedModel model_;
  PointingThumb thumb_;
};

/// The thumb goes down through the middle to the table. Two hands take turns, each from its own
/// side.
class Bore final : public KneadPlan {
public:
  Bore(const KneadedModel& model, const hand::HandSkeleton& skeleton)
      : model_(model), thumb_(skeleton), side_(skeleton.side() == Side::right ? 1.0 : -1.0) {}

  double length_s() const noexcept override { return turn_s * (turns + 0.5); }

  Pose at(double time_s) const noexcept override {
    const double own_s = std::max(0.0, time_s - (side_ > 0.0 ? 0.0 : 0.5 * turn_s));
    const double t = own_s - turn_s * std::min(std::floor(own_s / turn_s), turns - 1.0);
    const double lift = 1.0 - ease(t, 0.4, 1.1) + ease(t, 2.3, 2.9);
    const double aside = aside_m * (1.0 - ease(t, 0.0, 0.5) + ease(t, 2.7, 3.2));
    Vector3d tip = model_.middle() + side_ * aside * Vector3d::UnitX();
    tip.y() = model_.low.y() + lift * (model_.height() + away_m);
    return thumb_.at(tip, -Vector3d::UnitY());
  }

private:
  static constexpr double turn_s = 6.4; ///< from one bore to the same hand's next
  static constexpr double aside_m =
      0.11; ///< between them, where it leaves space for the other hand
  static constexpr double turns = 2.0;

  KneadedModel model_;
  PointingThumb thumb_;
  double side_; ///< 1: right
};

/// The palm that holds the wall against the thumb.
class Wall final : public KneadPlan {
public:
  Wall(const KneadedModel& model, const hand::HandSkeleton& skeleton)
      : model_(model), palm_(skeleton) {}

  double length_s() const noexcept override { return BowlRounds::length_s(); }

  Pose at(double time_s) const noexcept override {
    const BowlRounds now = BowlRounds::at(time_s);
    const double held =
        now.is_pressing ? ease(now.part, 0.05, 0.35) * (1.0 - ease(now.part, 0.65, 0.95)) : 0.0;
    const double wall = BowlRounds::wall[now.round] * model_.radius();
    // From one press to the next it goes around the model, not through it.
    constexpr double end_s = BowlRounds::enter_s + BowlRounds::all_s;
    const double off =
        1.0 - ease(time_s, 0.0, BowlRounds::enter_s) + ease(time_s, end_s, BowlRounds::length_s());
    const double free = (1.0 - held) * aside_m + off * (away_m - aside_m);
    const Vector3d out = BowlRounds::along(now.going_rad);
    const Vector3d along = Vector3d::UnitY().cross(out);
    Vector3d at = model_.middle() + (wall + free) * out;
    at.y() = std::max(at.y(), model_.low.y() + half_breadth_m); // of the table
    return {palm_.angles(), palm_.wrist(at, along, out)};
  }

private:
  static constexpr double half_breadth_m = 0.046; ///< half of a palm's breadth
  static constexpr double aside_m = 0.025;        ///< from the wall, between presses

  KneadedModel model_;
  Palm palm_;
};

/// Thumb and index finger close on a side of the model, pull, and open.
class Pinch final : public KneadPlan {
public:
  Pinch(const KneadedModel& model, const hand::HandSkeleton& skeleton)
      : model_(model), fingers_(skeleton, open_gap_m(radius()), pinch_gap_m) {}

  double length_s() const noexcept override { return 4.8; }

  Pose at(double time_s) const noexcept override {
    const double closed = ease(time_s, 1.0, 2.0) - ease(time_s, 3.5, 3.9);
    const double out = away_m * (1.0 - ease(time_s, 0.0, 0.9)) - into_m +
                       pull_m * ease(time_s, 2.1, 3.3) + 2.0 * away_m * ease(time_s, 3.9, 4.8);
    return fingers_.at(model_.middle() + (radius() + out) * fingers_.outwards(), closed);
  }

private:
  static double open_gap_m(double radius_m) noexcept {
    const double chord = std::sqrt(std::max(0.0, into_m * (2.0 * radius_m - into_m)));
    return 2.0 * (std::min(chord, max_chord_m) + clear_m);
  }
  double radius() const noexcept { return 0.5 * (model_.high.x() - model_.low.x()); }

  static constexpr double clear_m = 0.010;     ///< the fingertips' distance, before they close
  static constexpr double into_m = 0.016;      ///< the model, before they close
  static constexpr double max_chord_m = 0.027; ///< no hand opens wider
  static constexpr double pull_m = 0.032;

  KneadedModel model_;
  PinchingFingers fingers_;
};

enum class CutTool : std::uint8_t {
  wire,  ///< between both index fingertips, which lead it past the model
  knife, ///< at the tip of an index finger that points at the model
};

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
  static constexpr double lift = 0.5;         ///< relative to the model's height
  static constexpr double press = 0.02;       ///< deeper than it was, relative to the height
  static constexpr double aside = 0.7;        ///< relative to its breadth

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
  double side_;      ///< the sign of x
  Vector3d fingers_; ///< where they point to while it cuts
  Vector3d tip_m_;
};

} // namespace

std::unique_ptr<KneadPlan> plan_of(KneadTask task, const KneadedModel& model,
                                   const hand::HandSkeleton& skeleton) {
  if (task == KneadTask::press) return std::make_unique<Flatten>(model, skeleton);
  if (task == KneadTask::grip) return std::make_unique<Pinch>(model, skeleton);
  if (task == KneadTask::carry) return std::make_unique<Carry>(model, skeleton);
  if (task == KneadTask::cut) return std::make_unique<CutAndCarry>(CutTool::wire, model, skeleton);
  if (task == KneadTask::slice)
    return std::make_unique<CutAndCarry>(CutTool::knife, model, skeleton);
  if (task == KneadTask::bore) return std::make_unique<Bore>(model, skeleton);
  if (skeleton.side() == Side::right) return std::make_unique<Thumb>(model, skeleton);
  return std::make_unique<Wall>(model, skeleton);
}

} // namespace nendo::motions
