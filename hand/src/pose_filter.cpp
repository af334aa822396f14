#include <nendo/hand/pose_filter.hpp>

#include <algorithm>
#include <cmath>

#include "one_euro.hpp"

namespace nendo::hand {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Returns the rotation vector, in radians, of the shorter way from one turn to another.
Vector3d rotation_between(const Quaterniond& from, const Quaterniond& to) noexcept {
  const Quaterniond by = to * from.conjugate();
  const double sine = by.vec().norm();
  const double half_rad = std::atan2(sine, std::abs(by.w()));
  const double per_sine = sine > 1e-9 ? 2.0 * half_rad / sine : 2.0;
  return std::copysign(per_sine, by.w()) * by.vec();
}

/// As JointFilter: the change counts in full, even if time has not advanced.
Vector3d filtered_velocity(const Vector3d& velocity, const Vector3d& change, double interval_s,
                           double tau_s) noexcept {
  return (tau_s * velocity + change) / (tau_s + interval_s);
}

} // namespace

PoseFilter::PoseFilter(const PoseFilterOptions& options) noexcept : options_(options) {
  options_.min_cutoff_hz = limited_cutoff_hz(options.min_cutoff_hz);
  options_.derivative_cutoff_hz = limited_cutoff_hz(options.derivative_cutoff_hz);
  options_.beta_hz_per_m_s = limited_beta(options.beta_hz_per_m_s);
  options_.beta_hz_per_rad_s = limited_beta(options.beta_hz_per_rad_s);
}

PoseLatency PoseFilter::latency() const noexcept {
  if (!begun_) return {};
  return {
      time_constant_of(options_.min_cutoff_hz + options_.beta_hz_per_m_s * velocity_m_s_.norm()),
      time_constant_of(options_.min_cutoff_hz +
                       options_.beta_hz_per_rad_s * turn_velocity_rad_s_.norm())};
}

void PoseFilter::restart(const PoseSample& sample) noexcept {
  last_position_m_ = position_m_ = Vector3d::Map(sample.position_m.data());
  last_turn_ = turn_ = Quaterniond(sample.turn_xyzw.data());
  velocity_m_s_.setZero();
  turn_velocity_rad_s_.setZero();
  begun_ = true;
}

void PoseFilter::step_position(const Vector3d& position_m, double interval_s) noexcept {
  velocity_m_s_ = filtered_velocity(velocity_m_s_, position_m - last_position_m_, interval_s,
                                    time_constant_of(options_.derivative_cutoff_hz));
  last_position_m_ = position_m;
  const double weight = interval_s / (interval_s + latency().position_s);
  position_m_ += weight * (position_m - position_m_);
}

void PoseFilter::step_turn(const Quaterniond& turn, double interval_s) noexcept {
  turn_velocity_rad_s_ =
      filtered_velocity(turn_velocity_rad_s_, rotation_between(last_turn_, turn), interval_s,
                        time_constant_of(options_.derivative_cutoff_hz));
  last_turn_ = turn;
  const double weight = interval_s / (interval_s + latency().turn_s);
  turn_ = turn_.slerp(weight, turn).normalized(); // slerp goes the shorter way
}

PoseSample PoseFilter::pass(const PoseSample& sample) noexcept {
  if (options_.kind == FilterKind::off) return sample;
  const double interval_s = seconds_between(last_time_, sample.measured);
  last_time_ = sample.measured;
  if (!begun_ || !(std::abs(interval_s) <= longest_interval_s)) {
    restart(sample);
    return sample;
  }
  const double advanced_s = std::max(interval_s, 0.0);
  step_position(Vector3d::Map(sample.position_m.data()), advanced_s);
  step_turn(Quaterniond(sample.turn_xyzw.data()), advanced_s);
  PoseSample filtered = sample;
  Vector3d::Map(filtered.position_m.data()) = position_m_;
  Eigen::Vector4d::Map(filtered.turn_xyzw.data()) = turn_.coeffs();
  return filtered;
}

} // namespace nendo::hand
