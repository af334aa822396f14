#include "bench/clay_kneading.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include <nendo/flow/clay_hands.hpp>
#include <nendo/hand/inverse_kinematics.hpp>

#include "bench/clay_trial.hpp"
#include "bench/deform_frames.hpp"
#include "bench/percentiles.hpp"
#include "bench/refined_clay.hpp"
#include "reference/icosphere.hpp"

namespace nendo::bench {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using hand::HandBody;

constexpr double mm_a_m = 1000.0;
constexpr double far_mm = 1000.0;     // where a body touches nothing
constexpr double palm_skin_mm = 16.5; // below the wrist's axis

/// From 0 to 1 between two times.
double ease(double time, double from, double to) {
  const double share = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

struct Plan {
  double ball_mm, softness_mm, seconds;
};
Plan plan_of(KneadedShape shape) {
  if (shape == KneadedShape::cake) return {25.0, 18.0, 10.7};
  if (shape == KneadedShape::bowl) return {32.0, 18.0, 10.6};
  if (shape == KneadedShape::sausage) return {22.0, 18.0, 11.4};
  return {34.0, 18.0, 3.4};
}

/// A wrist whose -Z leads to `fingers` and whose +Y leads out of the `back` of the hand.
Isometry3d wrist_of(const Vector3d& fingers, const Vector3d& back, const Vector3d& place) {
  Isometry3d wrist = Isometry3d::Identity();
  const Vector3d z = -fingers.normalized();
  const Vector3d x = back.cross(z).normalized();
  wrist.linear() << x, z.cross(x), z;
  wrist.translation() = place;
  return wrist;
}

hand::JointAngles flat_hand() {
  hand::JointAngles angles;
  for (auto& finger : angles.fingers)
    finger = {0.05, 0.0, 0.08, 0.05};
  angles.thumb_abduction_rad = 0.1;
  return angles;
}

/// A fist but for the index finger.
hand::JointAngles pointing_hand() {
  hand::JointAngles angles;
  for (auto& finger : angles.fingers)
    finger = {1.4, 0.0, 1.6, 1.0};
  angles.fingers[0] = {0.05, 0.0, 0.1, 0.05};
  angles.thumb_mcp_flexion_rad = 0.5;
  return angles;
}

} // namespace

ClayKneading::ClayKneading(KneadedShape shape)
    : shape_(shape), skeleton_(Side::right), body_(skeleton_),
      parts_(bodies * HandBody::part_count) {
  for (auto& finger : pinch_.fingers)
    finger = {1.2, 0.0, 1.4, 0.9};
  pinch_.fingers[0] = {0.6, 0.0, 0.5, 0.3};
  pinch_.thumb_roll_rad = 0.6;
  pinch_.thumb_abduction_rad = 0.5;
}

double ClayKneading::ball_radius_mm() const noexcept {
  return plan_of(shape_).ball_mm;
}
double ClayKneading::softness_mm() const noexcept {
  return plan_of(shape_).softness_mm;
}
int ClayKneading::ticks() const noexcept {
  return static_cast<int>(plan_of(shape_).seconds * rate_hz);
}

void ClayKneading::place_hand(std::size_t body, const hand::JointAngles& angles,
                              const Isometry3d& wrist_mm) {
  Isometry3d wrist = wrist_mm;
  wrist.translation() /= mm_a_m;
  flow::contact_parts(body_, skeleton_.pose(angles, wrist), mm_a_m,
                      {parts_.data() + body * HandBody::part_count, HandBody::part_count});
}

/// Two large triangles, 20 mm thick. The other parts are far away.
void ClayKneading::place_table(double top_mm) {
  put_away(1);
  const auto corner = [&](double x, double y) { return Vector3d(x, y, top_mm - 10.0); };
  for (const double side : {1.0, -1.0}) {
    deform::ContactPart& part = parts_[HandBody::part_count + (side > 0.0 ? 0 : 1)];
    part.corner_count = 3;
    part.corners = {corner(-200, -200), corner(200, 200), corner(200 * side, -200 * side)};
    part.radii = {10.0, 10.0, 10.0};
    part.frame.setIdentity();
  }
}

void ClayKneading::put_away(std::size_t body) {
  for (std::size_t at = 0; at < HandBody::part_count; ++at) {
    deform::ContactPart& part = parts_[body * HandBody::part_count + at];
    part.corner_count = 2;
    part.corners.fill(Vector3d::Constant(-far_mm));
    part.radii.fill(1.0);
    part.frame.setIdentity();
  }
}

/// Seven presses on a table, each turned.
void ClayKneading::pose_cake(double time) {
  constexpr std::array<double, 7> heights_mm{28.0, 23.0, 19.0, 17.0, 16.0, 15.5, 15.0};
  const double bottom = -ball_radius_mm() + 4.0 * ease(time, 0.0, 0.3);
  const int press = std::min(6, static_cast<int>(time / 1.5));
  const double since = time - 1.5 * press;
  const double above = heights_mm[static_cast<std::size_t>(press)] + 40.0 -
                       28.0 * ease(since, 0.0, 0.2) - 12.0 * ease(since, 0.15, 0.95) +
                       45.0 * ease(since, 1.1, 1.45);
  const Matrix3d turn = Eigen::AngleAxisd(2.4 * press, Vector3d::UnitZ()).matrix();
  const Vector3d middle(0.0, 0.0, -ball_radius_mm() + 4.0 + above + palm_skin_mm);
  place_hand(0, flat_hand(),
             wrist_of(turn * Vector3d::UnitX(), Vector3d::UnitZ(),
                      middle - turn * Vector3d(62.0, 0.0, 0.0)));
  place_table(bottom);
}

/// A finger goes down the middle, and then presses outwards in three rounds of ten, against the
/// palm of the other hand.
void ClayKneading::pose_bowl(double time) {
  constexpr std::array<double, 3> out_mm{8.0, 14.0, 19.0};
  constexpr std::array<double, 3> wall_mm{36.0, 38.0, 40.0};
  constexpr double down_s = 1.2;
  constexpr double press_s = 0.3;
  const int press = std::clamp(static_cast<int>((time - down_s) / press_s), 0, 29);
  const auto round = static_cast<std::size_t>(press / 10);
  const bool is_down = time >= down_s;
  const double since = is_down ? (time - down_s) / press_s - press : 0.0;
  const double angle = 2.0 * std::numbers::pi * (press + 0.5 * static_cast<double>(round)) / 10.0;
  const Vector3d outwards(std::cos(angle), std::sin(angle), 0.0);
  const bool is_over = time > down_s + 30.0 * press_s;
  const double out = is_down && !is_over
                         ? out_mm[round] * ease(since, 0.0, 0.4) * (1.0 - ease(since, 0.65, 1.0))
                         : 0.0;
  const double deep = -ball_radius_mm() + 16.0;
  const Vector3d tip = out * outwards + Vector3d(0.0, 0.0,
                                                 deep + 70.0 * (1.0 - ease(time, 0.0, 1.1)) +
                                                     90.0 * ease(time, 10.2, 10.5));
  const hand::JointAngles pointing = pointing_hand();
  const Isometry3d above = wrist_of(-Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::Zero());
  const Vector3d to_tip =
      mm_a_m * skeleton_.pose(pointing, above)[hand::Joint::index_tip].translation();
  place_hand(0, pointing, wrist_of(-Vector3d::UnitZ(), Vector3d::UnitX(), tip - to_tip));
  const double away = is_down && !is_over
                          ? 30.0 * (1.0 - ease(since, 0.0, 0.3)) + 30.0 * ease(since, 0.7, 1.0)
                          : 60.0;
  const Vector3d aside = Vector3d::UnitZ().cross(outwards);
  place_hand(
      1, flat_hand(),
      wrist_of(aside, outwards, (wall_mm[round] + palm_skin_mm + away) * outwards - 62.0 * aside));
}

/// Thumb and index finger close, pull, open and leave.
void ClayKneading::pose_nose(double time) {
  const double gap = 60.0 - 44.0 * ease(time, 0.5, 1.1) + 44.0 * ease(time, 2.5, 2.9);
  const Vector3d middle(ball_radius_mm() + 30.0 - 36.0 * ease(time, 0.1, 0.5) +
                            28.0 * ease(time, 1.25, 2.4) + 60.0 * ease(time, 2.9, 3.3),
                        0.0, 0.0);
  const Isometry3d wrist =
      wrist_of(-Vector3d::UnitX(), Vector3d::UnitZ(), middle + Vector3d(118.0, 22.0, 42.0));
  hand::FingertipTargets targets;
  targets[0] = {(middle + Vector3d(0.0, 0.0, -0.5 * gap)) / mm_a_m, 1.0};
  targets[1] = {(middle + Vector3d(0.0, 0.0, 0.5 * gap)) / mm_a_m, 1.0};
  Isometry3d wrist_m = wrist;
  wrist_m.translation() /= mm_a_m;
  pinch_ = inverse_kinematics(skeleton_, wrist_m, targets, pinch_).angles;
  place_hand(0, pinch_, wrist);
  put_away(1);
}

/// Two palms whose fingers lead to opposite sides rub it between them, there and back, and come
/// nearer.
void ClayKneading::pose_sausage(double time) {
  constexpr double closed_s = 0.5;
  constexpr double rub_s = 0.8; // there and back
  constexpr double end_s = 10.7;
  constexpr double aside_mm = 26.0;
  constexpr double last_gap_mm = 29.0; // nearer costs volume: all of the clay is enclosed
  constexpr double middle_mm = 58.0;   // of the palm, from the wrist
  const double rubs = std::clamp((time - closed_s) / rub_s, 0.0, (end_s - closed_s) / rub_s);
  const double aside = aside_mm * std::sin(2.0 * std::numbers::pi * rubs);
  const double first_gap = 2.0 * ball_radius_mm() - 3.0;
  const double gap = first_gap + 40.0 * (1.0 - ease(time, 0.0, closed_s)) -
                     (first_gap - last_gap_mm) * std::clamp((time - closed_s) / 9.0, 0.0, 1.0) +
                     60.0 * ease(time, end_s, end_s + 0.5);
  const Vector3d fingers(std::cos(turn_rad_), std::sin(turn_rad_), 0.0);
  for (const double side : {1.0, -1.0})
    place_hand(side > 0.0 ? 0 : 1, flat_hand(),
               wrist_of(side * fingers, side * Vector3d::UnitZ(),
                        middle_ + side * ((aside - middle_mm) * fingers +
                                          (0.5 * gap + palm_skin_mm) * Vector3d::UnitZ())));
}

void ClayKneading::see(const Eigen::Matrix3Xd& vertices) {
  constexpr double follow = 0.2; // of the way, a tick
  constexpr double follow_turn = 0.1;
  const Vector3d middle = vertices.rowwise().mean();
  middle_ += follow * (middle - middle_);
  const Eigen::Matrix2Xd flat = (vertices.colwise() - middle).topRows<2>();
  const Eigen::Matrix2d spread = flat * flat.transpose();
  // The long axis as a double angle. As long as the clay is round it says nothing.
  const Eigen::Vector2d axis(spread(0, 0) - spread(1, 1), 2.0 * spread(0, 1));
  const double across = 0.5 * std::atan2(axis.y(), axis.x()) - 0.5 * std::numbers::pi;
  turn_rad_ += follow_turn * axis.norm() / spread.trace() *
               std::remainder(across - turn_rad_, std::numbers::pi);
}

Vector3d extents_mm(const Eigen::Matrix3Xd& vertices) {
  const Eigen::Matrix3Xd off = vertices.colwise() - vertices.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(off * off.transpose());
  const Eigen::Matrix3Xd along = axes.eigenvectors().rowwise().reverse().transpose() * off;
  return along.rowwise().maxCoeff() - along.rowwise().minCoeff();
}

std::span<const deform::ContactPart> ClayKneading::at(int tick) {
  const double time = tick / rate_hz;
  if (shape_ == KneadedShape::cake) pose_cake(time);
  if (shape_ == KneadedShape::bowl) pose_bowl(time);
  if (shape_ == KneadedShape::nose) pose_nose(time);
  if (shape_ == KneadedShape::sausage) pose_sausage(time);
  return parts_;
}

KneadedClay knead(KneadedShape shape, const KneadingOptions& options) {
  constexpr int refine_ticks = 9;
  ClayKneading hands(shape);
  KneadedClay result;
  RefinedClay clay(reference::icosphere(options.level, options.scale * hands.ball_radius_mm()),
                   ClayKneading::bodies, HandBody::part_count,
                   {.radius_mm = hands.softness_mm(), .lies_on_table = hands.lies_on_table()});
  clay.begin(hands.at(0));
  const double whole = clay_volume(clay.shown());
  std::vector<double> left_mm, times_us;
  for (int tick = 1; tick <= hands.ticks(); ++tick) {
    const auto parts = hands.at(tick);
    const auto begin = ThreadClock::now();
    const deform::ClayReport report = clay.press_to(parts);
    const std::chrono::duration<double, std::micro> took = ThreadClock::now() - begin;
    if (options.refines && tick % refine_ticks == 0) clay.refine(parts);
    result.max_held = std::max(result.max_held, report.held);
    result.turned_rad += report.turned_rad;
    const deform::Mesh& shown = clay.shown();
    hands.see(shown.vertices);
    result.last_volume = clay_volume(shown) / whole - 1.0;
    result.worst_volume = std::max(result.worst_volume, std::abs(result.last_volume));
    if (report.passes == 0) continue;
    left_mm.push_back(report.penetration_mm);
    times_us.push_back(took.count());
    result.mean_us += took.count();
  }
  result.shape = clay.shown();
  result.mean_us /= static_cast<double>(std::max<std::size_t>(1, times_us.size()));
  result.p99_us = percentile(times_us, 0.99);
  result.penetration_p99_mm = percentile(left_mm, 0.99);
  return result;
}

} // namespace nendo::bench
