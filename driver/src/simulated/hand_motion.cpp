#include "simulated/hand_motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <nendo/driver/simulated_glove.hpp>

#include "simulated/wrist_motion.hpp"

namespace nendo::driver {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;

// Everything in this file is in degrees until at() returns.
using Pose = std::array<double, sensor_slots>;
using Character = HandMotion::Character;

struct MotionName {
  std::string_view name;
  Motion motion;
};
constexpr std::array<MotionName, 7> motions{{{"rest", Motion::rest},
                                             {"wave", Motion::wave},
                                             {"pinch", Motion::pinch},
                                             {"grasp", Motion::grasp},
                                             {"sculpt", Motion::sculpt},
                                             {"table", Motion::table},
                                             {"faces", Motion::faces}}};

constexpr std::size_t mcp_at = 0, pip_at = 1; ///< in a row of finger_sensors

constexpr double& slot(Pose& pose, Sensor sensor) noexcept {
  return pose[static_cast<std::size_t>(sensor)];
}

// The hand at rest, half-way between flexed and stretched, where the muscles' passive forces
// balance; the fingers curl a little more towards the little finger. DIP angles follow from the PIP
// angles.
constexpr Pose relaxed{40, 15, 20, 30, 23, 34, 0, 0, 25, 36, 0, 7,
                       26, 36, 0,  6,  27, 34, 0, 8, 6,  0,  0, 0};

struct Limits {
  double least;
  double most;
};

// Active ranges of a healthy adult hand as goniometry textbooks round them: MCP 0-90, PIP 0-105,
// DIP 0-75, thumb MCP 0-55 and IP 0-80. No hyperextension (a glove's fabric resists it). Wrist: the
// middle of its range, where fingers are still free to close.
constexpr Limits mcp{0, 90};
constexpr Limits pip{0, 105};
constexpr Limits dip{0, 75};
constexpr Limits pair{0, 25};
constexpr Limits none{0, 0};
constexpr std::array<Limits, sensor_slots> limits{
    {{0, 75}, {0, 55}, {0, 80}, {0, 50}, mcp, pip, dip, none, mcp,     pip,       dip,       pair,
     mcp,     pip,     dip,     pair,    mcp, pip, dip, pair, {0, 25}, {-50, 50}, {-25, 25}, none}};

// Tendons and ligaments stop a joint softly. Smooth, and the identity up to `margin` before each
// end.
double softly_within(const Limits& limit, double angle) noexcept {
  constexpr double margin = 3.0;
  const double high = limit.most - margin;
  const double low = limit.least + margin;
  if (angle > high) return high + margin * std::tanh((angle - high) / margin);
  if (angle < low) return low + margin * std::tanh((angle - low) / margin);
  return angle;
}

double smoothstep(double from, double to, double x) noexcept {
  const double part = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return part * part * (3.0 - 2.0 * part);
}

double sine(double cycles) noexcept {
  return std::sin(tau * cycles);
}

// 0 at whole cycles, 1 half-way.
double swell(double cycles) noexcept {
  return 0.5 - 0.5 * std::cos(tau * cycles);
}

// Once a cycle: rises from a to b, stays 1, falls from c to d.
double plateau(double cycles, double a, double b, double c, double d) noexcept {
  const double part = cycles - std::floor(cycles);
  return smoothstep(a, b, part) - smoothstep(c, d, part);
}

// The motions: what each adds to the relaxed hand.

Pose wave(const Character& hand, double time_s) noexcept {
  constexpr double period_s = 2.5;
  const double cycle = time_s * hand.tempo / period_s + hand.phase;
  Pose add{};
  for (std::size_t k = 0; k < finger_sensors.size(); ++k) {
    const double bend = swell(cycle - 0.13 * static_cast<double>(k) - hand.lag[k]);
    slot(add, finger_sensors[k][mcp_at]) = hand.amplitude[k] * (60.0 * bend - 15.0);
    slot(add, finger_sensors[k][pip_at]) = hand.amplitude[k] * (65.0 * bend - 20.0);
  }
  for (const Sensor gap : gap_sensors)
    slot(add, gap) = 4.0 * sine(cycle);
  const double thumb = swell(cycle + 0.13);
  slot(add, Sensor::thumb_roll) = 12.0 * thumb;
  slot(add, Sensor::thumb_mcp) = 25.0 * thumb;
  slot(add, Sensor::thumb_ip) = 35.0 * thumb;
  return add;
}

/// What brings the pads of the thumb and of one finger together, from the relaxed hand, by the
/// hand's kinematics: the farther the finger, the more the thumb rolls and bends across the palm.
struct Pinch {
  double mcp, pip;
  double roll, abduction, thumb_mcp, thumb_ip, arch;
};
constexpr std::array<Pinch, finger_sensors.size()> pinches{{{26, 18, 5, -2, 11, 16, 0},
                                                            {26, 23, 20, 0, 19, 19, 3},
                                                            {23, 26, 32, 5, 26, 23, 3},
                                                            {27, 29, 35, 0, 40, 25, 3}}};

Pose pinch(const Character& hand, double time_s) noexcept {
  constexpr double period_s = 6.0;
  const double cycle = time_s * hand.tempo / period_s + hand.phase;
  Pose add{};
  for (std::size_t k = 0; k < finger_sensors.size(); ++k) {
    const double number = static_cast<double>(k);
    const double touch = plateau(cycle - 0.25 * number, 0.01, 0.09, 0.15, 0.23);
    const Pinch& by = pinches[k];
    slot(add, finger_sensors[k][mcp_at]) = hand.amplitude[k] * by.mcp * touch;
    slot(add, finger_sensors[k][pip_at]) = hand.amplitude[k] * by.pip * touch;
    slot(add, Sensor::thumb_roll) += by.roll * touch;
    slot(add, Sensor::thumb_abduction) += by.abduction * touch;
    slot(add, Sensor::thumb_mcp) += by.thumb_mcp * touch;
    slot(add, Sensor::thumb_ip) += by.thumb_ip * touch;
    slot(add, Sensor::palm_arch) += by.arch * touch;
  }
  return add;
}

Pose grasp(const Character& hand, double time_s) noexcept {
  constexpr double period_s = 4.0;
  const double cycle = time_s * hand.tempo / period_s + hand.phase;
  const double closed = swell(cycle);
  Pose add{};
  for (std::size_t k = 0; k < finger_sensors.size(); ++k) {
    const double bend = swell(cycle - hand.lag[k]);
    slot(add, finger_sensors[k][mcp_at]) = hand.amplitude[k] * (65.0 * bend - 15.0);
    slot(add, finger_sensors[k][pip_at]) = hand.amplitude[k] * (78.0 * bend - 22.0);
  }
  for (const Sensor gap : gap_sensors)
    slot(add, gap) = 6.0 - 9.0 * closed;
  slot(add, Sensor::thumb_roll) = 22.0 * closed - 8.0;
  slot(add, Sensor::thumb_mcp) = 28.0 * closed - 6.0;
  slot(add, Sensor::thumb_ip) = 40.0 * closed - 8.0;
  slot(add, Sensor::thumb_abduction) = 8.0 - 18.0 * closed;
  slot(add, Sensor::palm_arch) = 10.0 * closed;
  return add;
}

// The wrist does most: it carries the fingertips, and with them what they hold, far out of the
// model and back into it. After ten seconds the hand pulls for the second time.
Pose sculpt(const Character& hand, double time_s) noexcept {
  constexpr double period_s = 8.0;
  constexpr double knead_hz = 1.1;
  const auto pulling = [](double at) { return plateau(at, 0.04, 0.16, 0.42, 0.54); };
  const auto pressing = [](double at) { return plateau(at, 0.52, 0.68, 0.86, 0.99); };
  const double cycle = time_s * hand.tempo / period_s + hand.phase;
  Pose add{};
  for (std::size_t k = 0; k < finger_sensors.size(); ++k) {
    const double turn = 0.25 * static_cast<double>(k);
    const double press = pressing(cycle - hand.lag[k]);
    const double depth = hand.amplitude[k] * (press - pulling(cycle - hand.lag[k]));
    const double knead = press * sine(knead_hz * time_s - turn);
    const double fidget =
        sine(0.6 * time_s + 1.5 * turn); // the short spells between press and pull live, too
    slot(add, finger_sensors[k][mcp_at]) = 13.0 * depth + 3.0 * knead + fidget;
    slot(add, finger_sensors[k][pip_at]) = 10.0 * depth + 2.0 * knead + 0.5 * fidget;
  }
  const double press = pressing(cycle);
  const double pull = pulling(cycle);
  for (const Sensor gap : gap_sensors)
    slot(add, gap) = 2.0 * press - 5.0 * pull;
  const double knead = press * sine(knead_hz * time_s + 0.5);
  slot(add, Sensor::thumb_roll) = 8.0 * press - 5.0 * pull + 2.0 * knead;
  slot(add, Sensor::thumb_mcp) = 8.0 * press - 5.0 * pull + 3.0 * knead;
  slot(add, Sensor::thumb_ip) = 10.0 * press - 6.0 * pull + 3.0 * knead;
  slot(add, Sensor::thumb_abduction) = 8.0 * pull - 4.0 * press;
  slot(add, Sensor::palm_arch) = 6.0 * press - 3.0 * pull;
  slot(add, Sensor::wrist_pitch) = 14.0 * press - 42.0 * pull;
  slot(add, Sensor::wrist_yaw) = 14.0 * pull - 8.0 * press;
  return add;
}

/// How far each finger of both hands bends for an expression, 0 to 1, and how far the index finger
/// moves away from the middle finger. Left hand first; thumb to little finger, then the spread.
using Bends = std::array<std::array<double, 6>, 2>;
constexpr std::size_t expression_count = 7;
constexpr std::size_t talk = 5;
constexpr std::array<Bends, expression_count> expressions{{
    {{{0, 1, 0, 0, 0, 0}, {0.3, 1, 0, 0, 0, 0}}},         // smile
    {{{0, 0, 1, 1, 0, 0}, {0, 0, 1, 1, 0, 0}}},           // frown
    {{{0, 0, 0, 0, 1, 0}, {1, 0, 0, 0, 1, 0}}},           // surprise
    {{{0, 0.15, 0, 0, 0.5, 0}, {0.15, 0.9, 0, 0, 0, 1}}}, // wink
    {{{1, 0, 0, 0.2, 0, 0}, {0.15, 0, 0, 0.2, 0, 0}}},    // pout
    {{{0.25, 0, 0, 0, 0.3, 0}, {0.45, 0, 0, 0, 0.3, 0}}}, // talk: the thumbs go to and fro
    {{{0, 1, 0, 0, 0.8, 0}, {0.8, 1, 0, 0, 0.8, 0}}},     // laugh
}};

Pose faces(Side side, double time_s) noexcept {
  constexpr double first_s = 1.4; // at rest, so that the hands grab a face at rest
  constexpr double each_s = 1.6;
  constexpr double talk_hz = 2.6;
  Pose add{};
  const double cycle = (time_s - first_s) / each_s;
  if (cycle < 0.0) return add;
  const auto number = static_cast<std::size_t>(cycle) % expression_count;
  const double size = plateau(cycle, 0.05, 0.35, 0.7, 1.0);
  std::array<double, 6> bend = expressions[number][side == Side::left ? 0 : 1];
  if (number == talk)
    bend[0] *= side == Side::left ? swell(0.5 * talk_hz * time_s) : swell(talk_hz * time_s);
  slot(add, Sensor::thumb_mcp) = 15.0 * size * bend[0];
  slot(add, Sensor::thumb_ip) = 25.0 * size * bend[0];
  for (std::size_t k = 0; k < finger_sensors.size(); ++k) {
    slot(add, finger_sensors[k][mcp_at]) = 30.0 * size * bend[k + 1];
    slot(add, finger_sensors[k][pip_at]) = 36.0 * size * bend[k + 1];
  }
  slot(add, Sensor::index_middle_abduction) = 14.0 * size * bend[5];
  return add;
}

// Ring and little finger share muscle bellies and tendon links: neither goes all its own way.
void couple_ring_and_little(Pose& add) noexcept {
  const auto mix = [](double& ring, double& little) {
    const double apart = little - ring;
    ring += 0.15 * apart;
    little -= 0.3 * apart;
  };
  mix(slot(add, Sensor::ring_mcp), slot(add, Sensor::little_mcp));
  mix(slot(add, Sensor::ring_pip), slot(add, Sensor::little_pip));
}

Pose gesture(Motion motion, Side side, const Character& hand, double time_s) noexcept {
  Pose add{};
  switch (motion) {
  case Motion::rest:
  case Motion::table: // has no relaxed hand
    return add;
  case Motion::wave:
    add = wave(hand, time_s);
    break;
  case Motion::pinch:
    add = pinch(hand, time_s);
    break;
  case Motion::grasp:
    add = grasp(hand, time_s);
    break;
  case Motion::sculpt:
    add = sculpt(hand, time_s);
    break;
  case Motion::faces:
    return faces(side, time_s); // of hands that have learned to bend each finger alone
  }
  couple_ring_and_little(add);
  slot(add, Sensor::wrist_pitch) += 6.0 * sine(0.11 * time_s * hand.tempo + hand.phase);
  slot(add, Sensor::wrist_yaw) += 3.0 * sine(0.17 * time_s * hand.tempo + hand.phase);
  return add;
}

// The forearm turns about the tracker's y, to the right, and about its z, down. The hand stays, so
// it extends as the wrist is raised, and turns to the left, which is towards a right hand's thumb,
// as the forearm turns to the right.
JointAngles on_table(Side side, double time_s) noexcept {
  const ForearmAngles forearm = forearm_angles(time_s);
  JointAngles angles{};
  slot(angles, Sensor::wrist_pitch) = forearm.pitch_rad;
  slot(angles, Sensor::wrist_yaw) = side == Side::right ? forearm.yaw_rad : -forearm.yaw_rad;
  return angles;
}

// Physiological tremor: 8 to 12 Hz, 0.2 degrees at most.
double tremor(const Character& hand, std::size_t k, double time_s) noexcept {
  constexpr double amplitude = 0.1;
  double sum = 0.0;
  for (std::size_t n = 0; n < 2; ++n) {
    sum += amplitude * sine(hand.tremor_hz[k][n] * time_s + hand.tremor_phase[k][n]);
  }
  return sum;
}

} // namespace

std::vector<std::string_view> motion_names() {
  std::vector<std::string_view> names;
  names.reserve(motions.size());
  for (const MotionName& entry : motions)
    names.push_back(entry.name);
  return names;
}

Result<Motion> find_motion(std::string_view name) {
  std::string names;
  for (const MotionName& entry : motions) {
    if (entry.name == name) return entry.motion;
    names.append(names.empty() ? "" : ", ").append(entry.name);
  }
  return Error{Errc::usage, "no motion '" + std::string(name) + "'; there are " + names};
}

JointRange joint_range(Sensor sensor) noexcept {
  const Limits& limit = limits[static_cast<std::size_t>(sensor)];
  return {from_degrees(limit.least), from_degrees(limit.most)};
}

double part_of_range(const JointAngles& angles, Sensor sensor) noexcept {
  const JointRange range = joint_range(sensor);
  const double angle_rad = angles[static_cast<std::size_t>(sensor)];
  return std::clamp((angle_rad - range.min_rad) / (range.max_rad - range.min_rad), 0.0, 1.0);
}

HandMotion::HandMotion(Motion motion, Side side, std::uint32_t seed) noexcept
    : motion_(motion), side_(side) {
  // The standard's distributions differ between libraries; the engine itself does not.
  std::mt19937 random(2 * seed + (side == Side::left ? 1 : 0));
  const auto between = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  character_.tempo = between(0.97, 1.03);
  character_.phase = between(0.0, 0.03) + (side == Side::left ? 0.08 : 0.0);
  for (std::size_t k = 0; k < finger_sensors.size(); ++k) {
    character_.amplitude[k] = between(0.94, 1.08);
    character_.lag[k] = 0.012 * static_cast<double>(k) + between(0.0, 0.01);
  }
  for (std::size_t k = 0; k < sensor_slots; ++k) {
    for (std::size_t n = 0; n < 2; ++n) {
      character_.tremor_hz[k][n] = between(8.0, 12.0);
      character_.tremor_phase[k][n] = between(0.0, 1.0);
    }
  }
}

JointAngles HandMotion::at(double time_s) const noexcept {
  assert(time_s >= 0.0);
  if (motion_ == Motion::table) return on_table(side_, time_s);
  constexpr double growth_s = 1.0;
  const double size = smoothstep(0.0, growth_s, time_s);
  const Pose add = gesture(motion_, side_, character_, time_s);
  Pose pose{};
  for (std::size_t k = 0; k < sensor_slots; ++k) {
    if (!sensors_22.has(static_cast<Sensor>(k))) continue;
    pose[k] = softly_within(limits[k], relaxed[k] + size * add[k] + tremor(character_, k, time_s));
  }
  // Few people can bend a DIP joint alone: the tendons make it follow the PIP joint by about two
  // thirds.
  for (const auto& [of_mcp, of_pip, of_dip] : finger_sensors)
    slot(pose, of_dip) = 2.0 / 3.0 * slot(pose, of_pip);
  for (double& angle : pose)
    angle = from_degrees(angle);
  return pose;
}

} // namespace nendo::driver
