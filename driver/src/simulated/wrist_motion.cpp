#include "simulated/wrist_motion.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <nendo/base/text.hpp>

namespace nendo::driver {
namespace {

constexpr std::array<std::string_view, 5> names_of_motions{"rest", "orbit", "walk", "table",
                                                           "cross"};

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>; // x y z w

constexpr double full_turn_rad = 2.0 * std::numbers::pi;
constexpr double orbit_radius_m = 0.3;
constexpr double orbit_turn_s = 12.0;
constexpr double walk_turn_s = 6.0;
constexpr double sway_m = 0.1;
constexpr double sway_s = 13.0;
// The circles of the motion `table`: within the range of a wrist, and of uneven size and speed, as
// a person draws them. Without that, only a hand that lies exactly flat would show when they were.
constexpr double pitch_cone_rad = 24.0 * std::numbers::pi / 180.0;
constexpr double yaw_cone_rad = 16.0 * std::numbers::pi / 180.0;
constexpr double circle_s = 2.0;
constexpr double tempo_s = 6.1;
constexpr double tempo_share = 0.2; ///< part of the speed that changes
constexpr double size_s = 4.3;
constexpr double size_share = 0.1;
constexpr double cross_s = 4.0;
constexpr double cross_half_m = 0.3;
constexpr double tremor_m = 0.0003;

Quaternion about_z(double angle) noexcept {
  return {0.0, 0.0, std::sin(0.5 * angle), std::cos(0.5 * angle)};
}
Quaternion about_y(double angle) noexcept {
  return {0.0, std::sin(0.5 * angle), 0.0, std::cos(0.5 * angle)};
}
Quaternion about_x(double angle) noexcept {
  return {std::sin(0.5 * angle), 0.0, 0.0, std::cos(0.5 * angle)};
}
Quaternion product(const Quaternion& a, const Quaternion& b) noexcept {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
          a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
          a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}
Vector rotated(const Quaternion& q, const Vector& v) noexcept {
  const Quaternion r = product(product(q, {v[0], v[1], v[2], 0.0}), {-q[0], -q[1], -q[2], q[3]});
  return {r[0], r[1], r[2]};
}

/// Returns the receiver's pose of a wrist's centre and a forearm's turn.
ReceiverPose receiver_at(const Vector& wrist_m, const Quaternion& turn) noexcept {
  const Vector offset = rotated(turn, receiver_to_wrist_m);
  return {{wrist_m[0] - offset[0], wrist_m[1] - offset[1], wrist_m[2] - offset[2]}, turn};
}

/// The time after which a motion that begins from rest is at full speed.
double eased(double time_s) noexcept {
  constexpr double ease_s = 1.0;
  return time_s < ease_s ? 0.5 * time_s * time_s / ease_s : time_s - 0.5 * ease_s;
}

double side_of(std::uint16_t station) noexcept {
  return station % 2 == 1 ? -1.0 : 1.0;
}

ReceiverPose rest(std::uint16_t station, std::uint32_t seed, double time_s) noexcept {
  const double phase = 0.7 * seed + 1.3 * station;
  const double tremor = tremor_m * std::sin(full_turn_rad * 8.3 * time_s + phase);
  return receiver_at({0.4 + tremor, 0.2 * side_of(station), -0.1 + 0.6 * tremor}, {0, 0, 0, 1});
}

ReceiverPose orbit(std::uint16_t station, double time_s) noexcept {
  const Quaternion turn = about_z(full_turn_rad * eased(time_s) / orbit_turn_s);
  const Vector from_centre = rotated(turn, {0.0, orbit_radius_m * side_of(station), 0.0});
  return receiver_at({0.5 + from_centre[0], from_centre[1], -0.1}, turn);
}

ReceiverPose walk(std::uint16_t station, double time_s) noexcept {
  const double moving_s = eased(time_s);
  const Quaternion turn = about_z(full_turn_rad * moving_s / walk_turn_s);
  const Vector from_centre = rotated(turn, {0.0, orbit_radius_m * side_of(station), 0.0});
  const double down = sway_m * std::sin(full_turn_rad * moving_s / sway_s);
  const Quaternion palm_inwards = about_x(0.25 * full_turn_rad * side_of(station));
  return receiver_at({0.5 + from_centre[0], from_centre[1], down - 0.1},
                     product(turn, palm_inwards));
}

ReceiverPose table(std::uint16_t station, double time_s) noexcept {
  const ForearmAngles forearm = forearm_angles(time_s);
  return receiver_at({0.4, 0.2 * side_of(station), 0.05},
                     product(about_y(forearm.pitch_rad), about_z(forearm.yaw_rad)));
}

ReceiverPose cross(std::uint16_t station, double time_s) noexcept {
  const double x = cross_half_m * std::cos(full_turn_rad * eased(time_s) / cross_s);
  return receiver_at({x, 0.25 * side_of(station), -0.15}, {0, 0, 0, 1});
}

} // namespace

Result<WristMotion> find_wrist_motion(std::string_view name) {
  if (const auto motion = enumerator_named<WristMotion>(names_of_motions, name)) return *motion;
  std::string names;
  for (const std::string_view known : names_of_motions)
    names.append(names.empty() ? "" : ", ").append(known);
  return Error{Errc::usage,
               "there is no motion \"" + std::string(name) + "\" of a tracker; there is " + names};
}

std::vector<std::string_view> wrist_motion_names() {
  return {names_of_motions.begin(), names_of_motions.end()};
}

ForearmAngles forearm_angles(double time_s) noexcept {
  const double phase =
      full_turn_rad * time_s / circle_s +
      tempo_share * tempo_s / circle_s * std::sin(full_turn_rad * time_s / tempo_s);
  const double size = 1.0 + size_share * std::sin(full_turn_rad * time_s / size_s);
  return {size * yaw_cone_rad * std::cos(phase), size * pitch_cone_rad * std::sin(phase)};
}

ReceiverPose receiver_pose(WristMotion motion, std::uint16_t station, std::uint32_t seed,
                           double time_s) noexcept {
  switch (motion) {
  case WristMotion::rest:
    return rest(station, seed, time_s);
  case WristMotion::orbit:
    return orbit(station, time_s);
  case WristMotion::walk:
    return walk(station, time_s);
  case WristMotion::table:
    return table(station, time_s);
  case WristMotion::cross:
    return cross(station, time_s);
  }
  return {};
}

} // namespace nendo::driver
