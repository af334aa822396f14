#include <nendo/hand/pose_gate.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nendo::hand {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Nearer to the transmitter, p and -p are so near to each other that only the prediction counts.
constexpr double min_flip_distance_m = 0.1;
/// A velocity needs at least this much time: stamps of arrival are inexact, because serial adapters
/// deliver several records at once, and the noise of two positions counts less.
constexpr double min_baseline_s = 0.012;
/// After a longer interval, the previous velocity says nothing about the next pose.
constexpr double longest_step_s = 0.1;
/// Intervals that only bound a speed count as at least that long, as for SensorGate.
constexpr double min_interval_s = 0.016;
/// An alternative is believed if it is so many times nearer to what was expected.
constexpr double times_nearer = 4.0;
/// A record is missing in an interval that is so many times longer than the pace of the stream.
constexpr double max_pace_ratio = 1.75;
/// The pace follows a shorter interval at once, and a longer one by this part of the way.
constexpr double pace_share = 1.0 / 32.0;
/// A slower stream is not doubted: hands get as far from the prediction by themselves, and another
/// pose comes too late.
constexpr double longest_doubted_pace_s = 0.020;

/// A FASTRAK's letters for a field that is too strong or too weak to measure. Such poses are noise,
/// so no number of them is a reason to believe the next one.
bool is_out_of_field(char error) noexcept {
  return error == 'j' || error == 'k';
}

} // namespace

Vector3d PoseGate::predicted_m(double interval_s) const noexcept {
  if (!has_velocity_) return last_.position_m;
  return last_.position_m + interval_s * velocity_m_s_;
}

bool PoseGate::is_flip(const Vector3d& position_m, double interval_s) const noexcept {
  // Whether -p is so many times nearer to a point than p.
  const auto is_mirrored = [&](double times, const Vector3d& point_m) {
    return times * (position_m + point_m).norm() < (position_m - point_m).norm();
  };
  const double distance_m = position_m.norm();
  // The prediction has a say for trackers without hemispheres: a hand that really passes their
  // origin during a short pause is where its velocity has taken it.
  if (distance_m > min_flip_distance_m)
    return is_mirrored(times_nearer, last_.position_m) && is_mirrored(1.0, predicted_m(interval_s));
  return has_velocity_ && distance_m > noise_m &&
         is_mirrored(times_nearer, predicted_m(interval_s));
}

double PoseGate::deviation_m(const Vector3d& position_m, double interval_s) const noexcept {
  const double from_prediction_m = (position_m - predicted_m(interval_s)).norm();
  if (!has_velocity_) return from_prediction_m;
  // The last pose may have been damaged within the tolerance: then this one is where those before
  // it led.
  const double since_before_s = seconds_between(before_last_.time, last_.time) + interval_s;
  const Vector3d led_m = before_last_.position_m + since_before_s * velocity_before_m_s_;
  const double from_before_m = (position_m - led_m).norm();
  if (from_before_m <= noise_m) return from_before_m;
  // By the time since the last pose; or one more step like the last one, which is right where
  // records arrive several at once, and their stamps say little about the time between them.
  return std::min(from_prediction_m, (position_m - last_.position_m - step_m_).norm());
}

bool PoseGate::is_expected(const Vector3d& position_m, double interval_s) const noexcept {
  // A velocity is no newer than the interval that it is from.
  const double change_s = std::max(interval_s, last_interval_s_);
  const double moved_m = has_velocity_ ? 0.5 * max_acceleration_m_s2 * change_s * change_s
                                       : max_speed_m_s * std::max(interval_s, min_interval_s);
  return deviation_m(position_m, interval_s) <= noise_m + moved_m;
}

bool PoseGate::is_doubtful(const Vector3d& position_m, double interval_s) const noexcept {
  return has_velocity_ && pace_s_ <= longest_doubted_pace_s && interval_s <= longest_step_s &&
         std::max(interval_s, last_interval_s_) > max_pace_ratio * pace_s_ &&
         deviation_m(position_m, interval_s) > certain_m;
}

bool PoseGate::is_expected(const Quaterniond& turn, double interval_s) const noexcept {
  const double turned_rad = last_turn_.angularDistance(turn);
  const double counted_s = std::max(interval_s, min_interval_s);
  if (turned_rad > turn_noise_rad + max_turn_speed_rad_s * counted_s) return false;
  // A hand that turns that fast did so before.
  if (turned_rad <= std::max(turn_noise_rad, times_nearer * last_turn_speed_rad_s_ * counted_s))
    return true;
  for (int component = 0; component < 4; ++component) {
    Quaterniond other = turn;
    other.coeffs()[component] *= -1.0;
    if (times_nearer * last_turn_.angularDistance(other) < turned_rad) return false;
  }
  return true;
}

void PoseGate::restart(const Point& point, const Quaterniond& turn) noexcept {
  last_ = newer_ = point;
  last_turn_ = turn;
  last_turn_speed_rad_s_ = 0.0;
  pace_s_ = longest_step_s;
  has_last_ = true;
  has_velocity_ = false;
}

void PoseGate::advance(const Point& point, const Quaterniond& turn, double interval_s) noexcept {
  if (interval_s > longest_step_s) return restart(point, turn);
  const bool had_velocity = has_velocity_;
  before_last_ = last_;
  velocity_before_m_s_ = velocity_m_s_;
  step_m_ = point.position_m - last_.position_m;
  last_interval_s_ = interval_s;
  pace_s_ = std::min(interval_s, pace_s_ + pace_share * (interval_s - pace_s_));
  last_turn_speed_rad_s_ = last_turn_.angularDistance(turn) / std::max(interval_s, min_interval_s);
  last_turn_ = turn;
  // A time that went back a little does not count.
  last_ = {point.position_m, std::max(last_.time, point.time)};
  if (seconds_between(newer_.time, last_.time) >= min_baseline_s) {
    older_ = newer_;
    newer_ = last_;
    has_velocity_ = true;
  }
  if (has_velocity_)
    velocity_m_s_ =
        (last_.position_m - older_.position_m) / seconds_between(older_.time, last_.time);
  if (had_velocity) return;
  before_last_ = last_;
  velocity_before_m_s_ = velocity_m_s_;
}

std::optional<PoseSample> PoseGate::pass(const PoseSample& sample) noexcept {
  Vector3d position_m = Vector3d::Map(sample.position_m.data());
  Quaterniond turn(sample.turn_xyzw.data());
  const bool is_possible = position_m.norm() <= options_.max_distance_m &&
                           std::abs(turn.norm() - 1.0) <= max_length_error; // not NaN
  if (!is_possible) {
    ++refused_;
    return std::nullopt;
  }
  turn.normalize();

  const double since_s = seconds_between(last_.time, sample.measured);
  const double interval_s = std::max(since_s, 0.0);
  bool restarts = !has_last_ || !(std::abs(since_s) <= longest_pause_s);
  bool is_mirrored = false;
  if (!restarts) {
    is_mirrored =
        is_flip(position_m, interval_s) ||
        (!is_expected(position_m, interval_s) && is_expected(Vector3d(-position_m), interval_s));
    if (is_mirrored) position_m = -position_m;
    restarts = !is_expected(position_m, interval_s) || !is_expected(turn, interval_s);
    const bool is_refused =
        restarts ? is_out_of_field(sample.error) || refusals_in_a_row_ < max_refusals_in_a_row
                 : is_doubtful(position_m, interval_s) && !std::exchange(has_doubted_, true);
    if (is_refused) {
      ++refusals_in_a_row_;
      ++refused_;
      return std::nullopt;
    }
  }
  refusals_in_a_row_ = 0;
  has_doubted_ = false;
  if (is_mirrored) ++flips_;
  has_restarted_ = restarts;
  const Point point{position_m, sample.measured};
  if (restarts)
    restart(point, turn);
  else
    advance(point, turn, interval_s);

  PoseSample passed = sample;
  Vector3d::Map(passed.position_m.data()) = position_m;
  Eigen::Vector4d::Map(passed.turn_xyzw.data()) = turn.coeffs();
  return passed;
}

} // namespace nendo::hand
