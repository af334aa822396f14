#include "motions/touching_hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "motions/sensor_angles.hpp"
#include "motions/touch_plan.hpp"

namespace nendo::motions {

using hand::Finger;

namespace {

double usable(double time_s) noexcept {
  return time_s > 0.0 && std::isfinite(time_s) ? time_s : 0.0;
}

} // namespace

TouchTarget TouchingFinger::target(double depth, double way_part) const noexcept {
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

Result<TouchingHand> TouchingHand::make(const deform::Mesh& model,
                                        const hand::HandSkeleton& skeleton,
                                        const TouchOptions& options) {
  auto plan = plan_touch(model, skeleton, options);
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
