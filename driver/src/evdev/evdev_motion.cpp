#include "evdev/evdev_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace nendo::driver::evdev {
namespace {

// All chosen.
constexpr double count_s = 0.0004; ///< a mouse's count: 0.1 mm at the default speed
constexpr double notch_s = 0.02;   ///< a wheel's notch: 5 mm at the default speed
constexpr double smoothing_s =
    0.03; ///< in which a mouse's movement is made: no step tears a stroke
constexpr double min_pending_m = 1e-6;
constexpr double max_step_s = 0.1;
constexpr std::int32_t max_counts = 1000; ///< max of one event
constexpr double min_dead_zone = 0.03;    ///< a part of half a range
constexpr double min_stick_dead_zone = 0.12;
constexpr double max_dead_zone = 0.5;

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>; // x y z w

Quaternion product(const Quaternion& a, const Quaternion& b) noexcept {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

Quaternion normalised(const Quaternion& q) noexcept {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

Quaternion turn_of(const Vector& rotation_rad) noexcept {
  const double angle = std::hypot(rotation_rad[0], rotation_rad[1], rotation_rad[2]);
  if (angle < 1e-12) return {0, 0, 0, 1};
  const double part = std::sin(0.5 * angle) / angle;
  return {rotation_rad[0] * part, rotation_rad[1] * part, rotation_rad[2] * part,
          std::cos(0.5 * angle)};
}

/// Returns the part of a rotation from the identity, the shorter way round.
Quaternion part_of_turn(const Quaternion& turn, double part) noexcept {
  const double sign = turn[3] < 0.0 ? -1.0 : 1.0;
  const double sine = std::hypot(turn[0], turn[1], turn[2]);
  if (sine < 1e-12) return {0, 0, 0, 1};
  const double angle = 2.0 * std::atan2(sine, sign * turn[3]);
  const double scale = sign * part * angle / sine;
  return turn_of({turn[0] * scale, turn[1] * scale, turn[2] * scale});
}

double in_box(double place_m) noexcept {
  return std::clamp(place_m, -box_half_m, box_half_m);
}

} // namespace

void EvdevMotion::set_device(InputKind kind, std::uint16_t first_button) noexcept {
  kind_ = kind;
  first_button_ = first_button;
  ranges_ = {};
  dropped_ = false;
  rest();
}

void EvdevMotion::set_range(std::size_t axis, const AxisRange& range) noexcept {
  ranges_[axis] = range.min < range.max ? range : AxisRange{};
}

bool EvdevMotion::is_trigger(std::size_t axis) const noexcept {
  return kind_ == InputKind::gamepad && (axis == ABS_Z || axis == ABS_RZ);
}

std::int32_t EvdevMotion::resting_value(std::size_t axis) const noexcept {
  const AxisRange& range = ranges_[axis];
  return is_trigger(axis) ? range.min : std::midpoint(range.min, range.max);
}

void EvdevMotion::set_value(std::size_t axis, std::int32_t value) noexcept {
  const AxisRange& range = ranges_[axis];
  const double min = range.min;
  const double length = is_trigger(axis) ? range.max - min : 0.5 * (range.max - min);
  const double centre = is_trigger(axis) ? min : min + length;
  const double least = kind_ == InputKind::gamepad ? min_stick_dead_zone : min_dead_zone;
  const double dead = std::clamp(range.flat / length, least, max_dead_zone);
  const double part = std::clamp((value - centre) / length, is_trigger(axis) ? 0.0 : -1.0, 1.0);
  const double beyond = std::max(std::abs(part) - dead, 0.0) / (1.0 - dead);
  deflections_[axis] = std::copysign(beyond, part);
  needs_values_ = false;
}

void EvdevMotion::rest() noexcept {
  deflections_ = {};
  pending_m_ = {};
}

void EvdevMotion::take(const Event& event, HostTime now) noexcept {
  advance(now);
  if (event.type == EV_SYN) {
    if (event.code == SYN_DROPPED) {
      dropped_ = true;
      rest();
    } else if (event.code == SYN_REPORT && std::exchange(dropped_, false)) {
      needs_values_ = true;
    }
    return;
  }
  if (dropped_) return;
  const bool is_absolute = kind_ == InputKind::six_absolute || kind_ == InputKind::gamepad;
  if (event.type == EV_ABS && is_absolute && event.code < axes) set_value(event.code, event.value);
  if (event.type == EV_REL && !is_absolute) take_relative(event, now);
  const bool is_first = first_button_ != 0 && event.code == first_button_;
  if (event.type == EV_KEY && is_first && event.value == 1) begin_return();
}

void EvdevMotion::take_relative(const Event& event, HostTime now) noexcept {
  if (kind_ == InputKind::six_relative) {
    if (event.code >= axes) return;
    set_value(event.code, event.value);
    updated_[event.code] = now;
    return;
  }
  const double counts = std::clamp(event.value, -max_counts, max_counts);
  if (event.code == REL_X) pending_m_[0] += counts * count_s * scale_.speed_m_s;
  if (event.code == REL_Y) pending_m_[1] -= counts * count_s * scale_.speed_m_s;
  if (event.code == REL_WHEEL) pending_m_[2] -= counts * notch_s * scale_.speed_m_s;
  for (std::size_t k = 0; k < pending_m_.size(); ++k)
    pending_m_[k] = in_box(pose_.position_m[k] + pending_m_[k]) - pose_.position_m[k];
}

void EvdevMotion::begin_return() noexcept {
  return_from_ = pose_;
  returned_s_ = 0.0;
  returning_ = true;
}

void EvdevMotion::advance(HostTime now) noexcept {
  const double seconds =
      last_ == HostTime{} ? 0.0 : std::clamp(seconds_between(last_, now), 0.0, max_step_s);
  last_ = now;
  if (returning_) {
    move_back(seconds);
  } else {
    move_by_axes(seconds);
  }
  if (kind_ != InputKind::six_relative) return;
  for (std::size_t axis = 0; axis < axes; ++axis)
    if (now - updated_[axis] > relative_rest) deflections_[axis] = 0.0;
}

/// A smooth step, so that its speed and its acceleration are those of an arm.
void EvdevMotion::move_back(double seconds) noexcept {
  returned_s_ += seconds;
  const double done =
      std::min(returned_s_ / std::chrono::duration<double>(return_time).count(), 1.0);
  const double left = 1.0 - done * done * (3.0 - 2.0 * done);
  for (std::size_t k = 0; k < pose_.position_m.size(); ++k)
    pose_.position_m[k] = left * return_from_.position_m[k];
  pose_.turn_xyzw = part_of_turn(return_from_.turn_xyzw, left);
  pending_m_ = {};
  returning_ = done < 1.0;
}

void EvdevMotion::move_by_axes(double seconds) noexcept {
  const auto& d = deflections_;
  Vector speed{d[ABS_X], -d[ABS_Z], d[ABS_Y]};
  Vector turn{d[ABS_RX], -d[ABS_RZ], d[ABS_RY]};
  if (kind_ == InputKind::gamepad) {
    speed = {d[ABS_X], -d[ABS_Y], d[ABS_Z] - d[ABS_RZ]};
    turn = {d[ABS_RY], -d[ABS_RX], 0.0};
  }
  const double made = 1.0 - std::exp(-seconds / smoothing_s);
  for (std::size_t k = 0; k < speed.size(); ++k) {
    const bool is_rest = std::abs(pending_m_[k]) < min_pending_m;
    const double step_m = is_rest ? pending_m_[k] : made * pending_m_[k];
    pending_m_[k] -= step_m;
    pose_.position_m[k] =
        in_box(pose_.position_m[k] + step_m + speed[k] * scale_.speed_m_s * seconds);
    turn[k] *= scale_.turn_rad_s * seconds;
  }
  pose_.turn_xyzw = normalised(product(turn_of(turn), pose_.turn_xyzw));
}

bool EvdevMotion::is_moving() const noexcept {
  const auto is_not_zero = [](double value) { return value != 0.0; };
  return returning_ || std::any_of(deflections_.begin(), deflections_.end(), is_not_zero) ||
         std::any_of(pending_m_.begin(), pending_m_.end(), is_not_zero);
}

} // namespace nendo::driver::evdev
