// The plan of a touching hand determines all of its motion, and is computed beforehand.

#include "motions/touching_hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <nendo/hand/angle.hpp>
#include <nendo/hand/inverse_kinematics.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "motions/surface_walk.hpp"
#include "motions/touch_score.hpp"

namespace nendo::motions {

using Eigen::Vector3d;
using hand::Angle;
using hand::Finger;
using hand::finger_count;
using hand::JointAngles;

struct TouchPlan {
  using Row = std::array<double, hand::angle_count>;

  struct FingerPlan {
    bool touches = false;
    double press_m = 0.0;            ///< where the score says 1
    double pull_m = 0.0;             ///< where it says -1
    double glide = 1.0;              ///< how much of its way it goes
    std::vector<SurfacePoint> way{}; ///< evenly, and so fine that what is between them is straight

    TouchTarget target(double depth, double way_part) const noexcept {
      if (!touches) return {};
      const double at = glide * way_part * static_cast<double>(way.size() - 1);
      const auto before = std::min(static_cast<std::size_t>(at), way.size() - 1);
      const auto after = std::min(before + 1, way.size() - 1);
      const double part = at - static_cast<double>(before);
      const SurfacePoint& a = way[before];
      const SurfacePoint& b = way[after];
      return {a.position_m + part * (b.position_m - a.position_m),
              (a.normal + part * (b.normal - a.normal)).stableNormalized(),
              depth * (depth > 0.0 ? press_m : pull_m)};
    }
  };

  TouchScore score;
  Eigen::Isometry3d T_stage_wrist = Eigen::Isometry3d::Identity();
  std::array<FingerPlan, finger_count> fingers{};
  std::vector<Row> keys{}; ///< evenly over the score's period

  TouchTarget target(hand::Finger finger, double time_s) const noexcept {
    const FingerPlan& own = fingers[static_cast<std::size_t>(finger)];
    return own.target(score.depth(finger, time_s), score.way(time_s));
  }
};

namespace {

double usable(double time_s) noexcept {
  return time_s > 0.0 && std::isfinite(time_s) ? time_s : 0.0;
}

// What the solver calls reached, and a little.
constexpr double reached_m = 1.5e-5;
// Strokes are far slower; where an angle has to be as fast, it goes from one solution to another.
constexpr double max_speed_rad_s = 4.0;
constexpr double key_step_s = 1.0 / 40.0;
// So fine that a straight line between two contacts is on the surface, whatever its edges: at worst
// it is off by half a step.
constexpr double way_step_m = 1e-4;
constexpr std::array<Finger, finger_count> all_fingers{Finger::thumb, Finger::index, Finger::middle,
                                                       Finger::ring, Finger::little};

// The hand that is about to touch: half-way between bent and stretched, from where a finger can go
// either way, the fingers a little apart.
JointAngles ready_hand() noexcept {
  JointAngles angles;
  angles.thumb_roll_rad = from_degrees(35);
  angles.thumb_abduction_rad = from_degrees(22);
  angles.thumb_mcp_flexion_rad = from_degrees(30);
  angles.thumb_ip_flexion_rad = from_degrees(30);
  constexpr std::array<double, 4> aside_deg{6, 0, -5, -12};
  for (std::size_t k = 0; k < angles.fingers.size(); ++k)
    angles.fingers[k] = {from_degrees(25), from_degrees(aside_deg[k]), from_degrees(50),
                         from_degrees(30)};
  angles.palm_arch_rad = from_degrees(6);
  return angles;
}

/// Where joint_angles() leaves an angle as it is, and no glove's fabric resists: fingers are not
/// bent backwards far, nor does one cross its neighbour.
hand::AngleLimits comfortable_limits() noexcept {
  hand::AngleLimits limits;
  for (std::size_t k = 0; k < hand::angle_count; ++k) {
    const Angle angle = hand::angle_at(k);
    limits.low[angle] = hand::limit_of(angle).soft_min_rad;
    limits.high[angle] = hand::limit_of(angle).soft_max_rad;
  }
  const auto narrow = [&](Angle angle, double low_deg, double high_deg) {
    limits.low[angle] = from_degrees(low_deg);
    limits.high[angle] = from_degrees(high_deg);
  };
  for (const Angle mcp : {Angle::index_mcp_flexion, Angle::middle_mcp_flexion,
                          Angle::ring_mcp_flexion, Angle::little_mcp_flexion})
    limits.low[mcp] = from_degrees(-15);
  narrow(Angle::index_mcp_abduction, -2, 25);
  narrow(Angle::middle_mcp_abduction, 0, 0); // which no glove measures
  narrow(Angle::ring_mcp_abduction, -20, 2);
  narrow(Angle::little_mcp_abduction, -40, -2);
  narrow(Angle::wrist_pitch, -60, 40);
  narrow(Angle::wrist_yaw, -20, 15);
  return limits;
}

// A place leaves one of a finger's four angles open, and all places together the wrist's pitch.
// They are settled beforehand, so that the same places come with the same angles again, and no
// angle jumps from one solution to another.
constexpr std::array<Angle, finger_count + 1> open_angles{
    Angle::thumb_ip_flexion, Angle::index_dip_flexion,  Angle::middle_dip_flexion,
    Angle::ring_dip_flexion, Angle::little_dip_flexion, Angle::wrist_pitch};

TouchPlan::Row row_of(const JointAngles& angles) noexcept {
  TouchPlan::Row row;
  for (std::size_t k = 0; k < row.size(); ++k)
    row[k] = angles[hand::angle_at(k)];
  return row;
}

/// Makes a plan: grabs, finds how far the fingers reach, and solves the keys.
class Planner {
public:
  Planner(const deform::Mesh& model, const hand::HandSkeleton& skeleton,
          const TouchOptions& options)
      : model_(model), skeleton_(skeleton), options_(options),
        plan_{TouchScore(skeleton.side(), options.seed)} {
    inverse_.limits = comfortable_limits();
    inverse_.solve_wrist = true; // the middle finger does not turn aside by itself
  }

  Result<TouchPlan> make() {
    take_hold();
    if (std::none_of(plan_.fingers.begin(), plan_.fingers.end(),
                     [](const auto& finger) { return finger.touches; }))
      return Error{Errc::bad_input, "no fingertip reaches a face of the model"};
    constexpr int max_rounds = 40;
    for (int round = 0; round < max_rounds; ++round) {
      find_postures();
      if (shorten()) continue;
      solve_keys(0.1); // what fails mostly fails here already
      if (shorten()) continue;
      solve_keys(key_step_s);
      if (!shorten()) return std::move(plan_);
    }
    return Error{Errc::bad_input, "the fingers find no space to move on the model"};
  }

private:
  struct Missed {
    bool press = false, pull = false, glide = false;
  };
  struct Posture {
    double time_s;
    JointAngles angles;
  };

  void take_hold() {
    const flow::Fingertips tips_wrist =
        skeleton_.pose(grip_, Eigen::Isometry3d::Identity()).fingertip_positions();
    std::array<std::optional<flow::Fingertips>, 2> tips;
    tips[flow::Placement::index_of(skeleton_.side())] = tips_wrist;
    const flow::Placement placement =
        flow::place_hands(model_, tips, {.model_size_m = options_.model_size_m});
    plan_.T_stage_wrist = placement.T_stage_wrist[flow::Placement::index_of(skeleton_.side())];

    std::mt19937 random(options_.seed);
    const double turn_rad = 2.0 * std::numbers::pi * static_cast<double>(random()) / 4294967296.0;
    // Along the palm: to the fingertips, to the side, and between.
    const Vector3d direction =
        plan_.T_stage_wrist.linear() * Vector3d(std::sin(turn_rad), 0.0, std::cos(turn_rad));
    const deform::Points normals = deform::vertex_normals(model_);
    for (const Finger finger : all_fingers) {
      const auto at = static_cast<std::size_t>(finger);
      auto& plan = plan_.fingers[at];
      const Vector3d tip =
          plan_.T_stage_wrist * Vector3d(tips_wrist.col(static_cast<Eigen::Index>(at)));
      const SurfacePatch patch(model_, normals, placement.units_per_metre, tip,
                               2.0 * TouchOptions::glide_m);
      plan.way = walk(patch, tip, direction, TouchOptions::glide_m, way_step_m);
      plan.touches = !plan.way.empty();
      plan.press_m = TouchOptions::press_m;
      plan.pull_m = TouchOptions::pull_m;
    }
    // Fingers that cannot touch from there stay off.
    for (std::size_t tries = 0; tries < finger_count; ++tries) {
      const auto solution = freely(0.0);
      const auto worst = std::max_element(solution.residual_m.begin(), solution.residual_m.end());
      if (*worst <= reached_m) {
        grip_ = solution.angles;
        return;
      }
      plan_.fingers[static_cast<std::size_t>(worst - solution.residual_m.begin())].touches = false;
    }
  }
  hand::FingertipTargets targets(double time_s) const noexcept {
    hand::FingertipTargets targets;
    for (const Finger finger : all_fingers) {
      const auto at = static_cast<std::size_t>(finger);
      if (plan_.fingers[at].touches) targets[at] = {plan_.target(finger, time_s).place_m(), 1.0};
    }
    return targets;
  }
  /// How far the wrist is stretched for what all fingers pull together, on average: fingers alone
  /// do not reach far out.
  double carried_rad(double time_s) const noexcept {
    constexpr double tip_reach_m = 0.16; // from the wrist to the fingertips
    double sum_m = 0.0;
    int count = 0;
    for (const Finger finger : all_fingers) {
      if (!plan_.fingers[static_cast<std::size_t>(finger)].touches) continue;
      sum_m += std::max(0.0, -plan_.target(finger, time_s).depth_m);
      ++count;
    }
    return count == 0 ? 0.0 : -sum_m / (count * tip_reach_m);
  }
  hand::InverseSolution freely(double time_s) const noexcept {
    JointAngles start = grip_;
    start.wrist_pitch_rad += carried_rad(time_s);
    return hand::inverse_kinematics(skeleton_, plan_.T_stage_wrist, targets(time_s), start,
                                    inverse_);
  }
  void find_postures() {
    constexpr double min_apart_s = 0.25; // the open angles do not hurry
    const double period_s = plan_.score.period_s();
    postures_.assign(1, {0.0, grip_});
    for (const double time_s : plan_.score.extremes_s()) {
      if (time_s - postures_.back().time_s < min_apart_s || period_s - time_s < min_apart_s)
        continue;
      const auto solution = freely(time_s);
      judge(time_s, solution, solution.angles, 1.0);
      postures_.push_back({time_s, solution.angles});
    }
    postures_.push_back({period_s, grip_});
  }
  void solve_keys(double step_s) {
    const auto count = static_cast<std::size_t>(std::ceil(plan_.score.period_s() / step_s));
    constexpr int enough_missed = 5; // to be the next round's task; they take long
    int missed = 0;
    plan_.keys.clear();
    JointAngles last = grip_;
    for (std::size_t n = 0; n < count; ++n) {
      const double time_s =
          plan_.score.period_s() * static_cast<double>(n) / static_cast<double>(count);
      const auto solution = solve(time_s, last);
      if (!judge(time_s, solution, last, step_s) && ++missed == enough_missed) return;
      last = solution.angles;
      plan_.keys.push_back(row_of(last));
    }
  }
  hand::InverseSolution solve(double time_s, const JointAngles& from) const noexcept {
    const auto after =
        std::upper_bound(postures_.begin(), postures_.end(), time_s,
                         [](double at_s, const Posture& p) { return at_s < p.time_s; });
    const Posture& a = *(after - 1);
    const Posture& b = *after;
    const double part = min_jerk((time_s - a.time_s) / (b.time_s - a.time_s));
    hand::InverseOptions options = inverse_;
    for (const Angle angle : open_angles) {
      options.limits.low[angle] = options.limits.high[angle] =
          a.angles[angle] + part * (b.angles[angle] - a.angles[angle]);
    }
    const double before_rad = carried_rad(a.time_s);
    const double carried =
        carried_rad(time_s) - before_rad - part * (carried_rad(b.time_s) - before_rad);
    options.limits.low.wrist_pitch_rad += carried;
    options.limits.high.wrist_pitch_rad += carried;
    return hand::inverse_kinematics(skeleton_, plan_.T_stage_wrist, targets(time_s), from, options);
  }
  /// A finger that does not reach its target, or reaches it too fast, must do less at that time.
  /// Returns whether none has to.
  bool judge(double time_s, const hand::InverseSolution& solution, const JointAngles& before,
             double step_s) noexcept {
    bool fine = true;
    for (const Finger finger : all_fingers) {
      const auto at = static_cast<std::size_t>(finger);
      double way_rad = 0.0;
      for (std::size_t k = 4 * at; k < 4 * at + 4; ++k) {
        const Angle angle = hand::angle_at(k);
        way_rad = std::max(way_rad, std::abs(solution.angles[angle] - before[angle]));
      }
      if (solution.residual_m[at] <= reached_m && way_rad <= max_speed_rad_s * step_s) continue;
      fine = false;
      const double depth = plan_.score.depth(finger, time_s);
      Missed& missed = missed_[at];
      (depth > 0.1 ? missed.press : depth < -0.1 ? missed.pull : missed.glide) = true;
    }
    return fine;
  }
  bool shorten() noexcept {
    bool any = false;
    for (std::size_t at = 0; at < finger_count; ++at) {
      const auto reduce = [&](bool missed, double& amount) {
        if (missed) amount *= 0.85;
        any = any || missed;
      };
      auto& plan = plan_.fingers[at];
      reduce(missed_[at].press, plan.press_m);
      reduce(missed_[at].pull, plan.pull_m);
      reduce(missed_[at].glide, plan.glide);
      missed_[at] = {};
    }
    return any;
  }

  const deform::Mesh& model_;
  const hand::HandSkeleton& skeleton_;
  TouchOptions options_;
  hand::InverseOptions inverse_;
  JointAngles grip_ = ready_hand();
  std::vector<Posture> postures_; ///< natural postures of a cycle
  std::array<Missed, finger_count> missed_{};
  TouchPlan plan_;
};

} // namespace

Result<TouchingHand> TouchingHand::make(const deform::Mesh& model,
                                        const hand::HandSkeleton& skeleton,
                                        const TouchOptions& options) {
  auto plan = Planner(model, skeleton, options).make();
  if (!plan) return plan.error();
  return TouchingHand(std::make_shared<const TouchPlan>(*std::move(plan)));
}

hand::JointAngles TouchingHand::angles(double time_s) const noexcept {
  const auto& keys = plan_->keys;
  const double at = usable(time_s) / plan_->score.period_s() * static_cast<double>(keys.size());
  const double whole = std::floor(at);
  const double x = at - whole;
  const auto first = static_cast<std::size_t>(std::fmod(whole, static_cast<double>(keys.size())));
  const auto key = [&](std::size_t ahead) -> const TouchPlan::Row& {
    return keys[(first + keys.size() + ahead - 1) % keys.size()];
  };
  // Catmull and Rom's cubic through the keys.
  const TouchPlan::Row& a = key(0);
  const TouchPlan::Row& b = key(1);
  const TouchPlan::Row& c = key(2);
  const TouchPlan::Row& d = key(3);
  hand::JointAngles angles;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double rising = 0.5 * (c[k] - a[k]);
    const double bend = a[k] - 2.5 * b[k] + 2.0 * c[k] - 0.5 * d[k];
    const double twist = 1.5 * (b[k] - c[k]) + 0.5 * (d[k] - a[k]);
    angles[hand::angle_at(k)] = b[k] + x * (rising + x * (bend + x * twist));
  }
  return angles;
}

hand::SensorAngles TouchingHand::sensor_angles(double time_s) const noexcept {
  return sensor_angles_of(angles(time_s));
}

TouchTarget TouchingHand::target(Finger finger, double time_s) const noexcept {
  return plan_->target(finger, usable(time_s));
}

bool TouchingHand::touches(Finger finger) const noexcept {
  return plan_->fingers[static_cast<std::size_t>(finger)].touches;
}

const Eigen::Isometry3d& TouchingHand::wrist_pose() const noexcept {
  return plan_->T_stage_wrist;
}

double TouchingHand::period_s() const noexcept {
  return plan_->score.period_s();
}

} // namespace nendo::motions
