#include <nendo/hand/joint_filter.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "one_euro.hpp"

namespace nendo::hand {
namespace {

constexpr double turn_rad = 2.0 * std::numbers::pi;
constexpr std::array<std::string_view, 2> kind_names{"off", "one-euro"};

bool is_possible(double angle_rad) noexcept {
  return std::abs(angle_rad) <= turn_rad; // not NaN
}

} // namespace

std::string_view name_of(FilterKind kind) noexcept {
  return kind_names[static_cast<std::size_t>(kind)];
}

std::optional<FilterKind> filter_named(std::string_view name) noexcept {
  for (std::size_t at = 0; at < kind_names.size(); ++at) {
    if (kind_names[at] == name) return static_cast<FilterKind>(at);
  }
  return std::nullopt;
}

JointFilter::JointFilter(const FilterOptions& options) noexcept : options_(options) {
  options_.min_cutoff_hz = limited_cutoff_hz(options.min_cutoff_hz);
  options_.derivative_cutoff_hz = limited_cutoff_hz(options.derivative_cutoff_hz);
  options_.beta_hz_per_rad_s = limited_beta(options.beta_hz_per_rad_s);
}

double JointFilter::time_constant_s(const Joint& joint) const noexcept {
  return time_constant_of(options_.min_cutoff_hz +
                          options_.beta_hz_per_rad_s * std::abs(joint.speed_rad_s));
}

// The paper's alpha is 1 / (1 + tau / T), so that alpha x + (1 - alpha) y = (T x + tau y) / (T +
// tau). In that form nothing is divided by an interval, which may be zero; and on a ramp of speed v
// the output is v tau late whatever the intervals, because (tau / (T + tau)) (v tau + v T) = v tau.
void JointFilter::step(Joint& joint, double angle_rad, double interval_s) const noexcept {
  const double speed_tau_s = time_constant_of(options_.derivative_cutoff_hz);
  joint.speed_rad_s =
      (speed_tau_s * joint.speed_rad_s + (angle_rad - joint.last_rad)) / (speed_tau_s + interval_s);
  joint.last_rad = angle_rad;
  const double weight = interval_s / (interval_s + time_constant_s(joint));
  const double before = joint.filtered_rad;
  const auto [low, high] = std::minmax(before, angle_rad);
  // Between the two, rounding included.
  joint.filtered_rad = std::clamp(before + weight * (angle_rad - before), low, high);
}

JointAngles JointFilter::pass(const JointAngles& angles, HostTime time) noexcept {
  if (options_.kind == FilterKind::off) return angles;
  const double interval_s = seconds_between(last_time_, time);
  const bool restarts = !begun_ || !(std::abs(interval_s) <= longest_interval_s);
  JointAngles filtered;
  for (std::size_t n = 0; n < angle_count; ++n) {
    Joint& joint = joints_[n];
    const double angle_rad = angles[angle_at(n)];
    if (!is_possible(angle_rad)) {
      joint.speed_rad_s = restarts ? 0.0 : joint.speed_rad_s;
    } else if (restarts) {
      joint = {angle_rad, angle_rad, 0.0};
    } else {
      step(joint, angle_rad, std::max(interval_s, 0.0));
    }
    filtered[angle_at(n)] = joint.filtered_rad;
  }
  last_time_ = time;
  begun_ = true;
  return filtered;
}

double JointFilter::latency_s(Angle angle) const noexcept {
  return begun_ ? time_constant_s(joints_[index_of(angle)]) : 0.0;
}

FilterLatency JointFilter::latency() const noexcept {
  FilterLatency latency;
  double behind_rad = 0.0;
  double speeds_rad_s = 0.0;
  for (std::size_t n = 0; n < angle_count; ++n) {
    const double joint_s = latency_s(angle_at(n));
    latency.worst_s = std::max(latency.worst_s, joint_s);
    latency.mean_s += joint_s / static_cast<double>(angle_count);
    const double speed_rad_s = std::abs(joints_[n].speed_rad_s);
    behind_rad += joint_s * speed_rad_s;
    speeds_rad_s += speed_rad_s;
  }
  latency.moving_s = speeds_rad_s > 0.0 ? behind_rad / speeds_rad_s : latency.mean_s;
  return latency;
}

} // namespace nendo::hand
