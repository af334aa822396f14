#include "reference/wearers.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace nendo::reference {
namespace {

using hand::Finger;
using hand::Joint;
using hand::PoseId;
using hand::SensorAngles;

constexpr std::size_t slot_of(Sensor sensor) noexcept {
  return static_cast<std::size_t>(sensor);
}

/// A kind of joint: how it moves, how people hold it, and how its sensor is made. Degrees, and
/// gains in thousandths of a radian a count. `straight` and `bent` are standard deviations of one
/// performance from what was asked; `shift` is by how much everyone errs when the joint is bent.
struct Kind {
  double low, high;
  double relaxed, relaxed_deviation;
  double straight, bent, shift;
  double gain, gain_deviation, offset, offset_deviation;
};
constexpr Kind mcp{-10, 90, 25, 12, 3, 5, 2, 14.0, 2.5, 75, 15};
constexpr Kind pip{0, 108, 35, 12, 3, 5, 2, 14.0, 2.5, 70, 15};
constexpr Kind dip{0, 78, 15, 8, 3.5, 7, -3, 13.5, 2.5, 70, 18};
constexpr Kind gap{0, 26, 4, 3, 2, 5, -2, 8.0, 2.0, 115, 18};
constexpr Kind thumb_roll{0, 88, 35, 14, 6, 7, -3, 13.0, 2.0, 105, 15};
constexpr Kind thumb_abduction{0, 60, 25, 10, 5, 7, 2, 10.5, 2.0, 115, 15};
constexpr Kind thumb_mcp{-5, 62, 15, 8, 4, 6, 3, 14.0, 2.5, 110, 15};
constexpr Kind thumb_ip{-8, 84, 15, 10, 4, 6, -2, 14.0, 2.5, 95, 15};
constexpr Kind arch{0, 28, 6, 4, 3, 6, -2, 8.5, 1.5, 95, 15};
constexpr Kind pitch{-68, 80, 0, 6, 4, 6, 3, 15.0, 1.5, 128, 8};
constexpr Kind yaw{-36, 26, 0, 5, 4, 5, 2, 13.0, 2.0, 120, 12};
constexpr Kind nothing{};
constexpr std::array<Kind, sensor_slots> kinds{thumb_roll, thumb_mcp, thumb_ip, thumb_abduction,
                                               mcp,        pip,       dip,      nothing,
                                               mcp,        pip,       dip,      gap,
                                               mcp,        pip,       dip,      gap,
                                               mcp,        pip,       dip,      gap,
                                               arch,       pitch,     yaw,      nothing};

// Between wearers a hand may be long and narrow or short and broad.
constexpr double min_length_m = 0.165;
constexpr double max_length_m = 0.212;

constexpr double noise_counts = 0.35;

// Pads do not meet at the same place each time.
constexpr double slip_deviation_m = 0.0015;
// Nor is the palm touched where nobody sees a mark.
constexpr double palm_slip_deviation_m = 0.004;

// How far the ends of a joint's range differ between people: as a part of it, but not less than.
constexpr double range_deviation = 0.06;
constexpr double min_range_deviation_deg = 3.0;

/// What the lines must read so that with their couplings they make these angles.
SensorAngles lines_of(const SensorAngles& angles, const hand::Calibration& truth) {
  SensorAngles lines = angles;
  for (std::size_t k = 2; k < hand::couplings.size(); ++k) {
    const auto [of, by] = hand::couplings[k];
    lines[slot_of(of)] -= truth.coupling_gains[k] * angles[slot_of(by)];
  }
  // Roll and abduction are mixed into each other: two equations with two unknowns.
  const double roll = angles[slot_of(Sensor::thumb_roll)];
  const double abduction = angles[slot_of(Sensor::thumb_abduction)];
  const double determinant = 1.0 - truth.coupling_gains[0] * truth.coupling_gains[1];
  lines[slot_of(Sensor::thumb_roll)] = (roll - truth.coupling_gains[0] * abduction) / determinant;
  lines[slot_of(Sensor::thumb_abduction)] =
      (abduction - truth.coupling_gains[1] * roll) / determinant;
  return lines;
}

/// The joints that a wearer moves to bring the pads together, and the angles from which a hand
/// begins, in degrees. The palm at the little finger's base is touched by the thumb alone.
struct TouchJoints {
  std::vector<std::size_t> slots;
  std::vector<double> liked_deg;
};
TouchJoints joints_for(PoseId id) {
  constexpr std::array<std::size_t, 4> firsts{
      slot_of(Sensor::index_mcp), slot_of(Sensor::middle_mcp), slot_of(Sensor::ring_mcp),
      slot_of(Sensor::little_mcp)};
  const auto with_finger = [&](std::size_t finger, std::vector<double> liked_deg) {
    const std::size_t first = firsts[finger];
    return TouchJoints{{0, 1, 2, 3, first, first + 1, first + 2}, std::move(liked_deg)};
  };
  // Thumb roll, MCP, IP and abduction, and the finger's three joints.
  switch (id) {
  case PoseId::pinch_index_flat:
    return with_finger(0, {60, 25, 10, 32, 60, 18, 6});
  case PoseId::pinch_index:
    return with_finger(0, {60, 25, 25, 35, 45, 50, 25});
  case PoseId::pinch_middle:
    return with_finger(1, {65, 25, 25, 35, 48, 50, 25});
  case PoseId::pinch_ring:
    return with_finger(2, {72, 38, 25, 38, 52, 52, 25});
  case PoseId::pinch_little:
    return with_finger(3, {75, 48, 25, 38, 55, 50, 25});
  default:
    return {{0, 1, 2, 3}, {45, 48, 48, 10}};
  }
}

} // namespace

FreeMotion::FreeMotion(std::uint64_t seed, const Ranges& ranges) : ranges_(ranges) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> slow(0.07, 0.2), fast(0.25, 0.8);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  for (Wave& wave : waves_)
    wave = {slow(random), fast(random), phase(random), phase(random)};
}

SensorAngles FreeMotion::angles_rad(double time_s) const {
  constexpr double tau = 2.0 * std::numbers::pi;
  SensorAngles angles{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Wave& wave = waves_[slot];
    const double swing = 0.6 * std::sin(tau * wave.slow_hz * time_s + wave.slow_phase) +
                         0.4 * std::sin(tau * wave.fast_hz * time_s + wave.fast_phase);
    const auto [low_rad, high_rad] = ranges_[slot];
    angles[slot] = low_rad + (0.5 + 0.5 * swing) * (high_rad - low_rad);
  }
  return angles;
}

Wearer::Wearer(std::uint64_t seed)
    : random_(seed * 7919 + 17), side_(seed % 2 == 1 ? Side::left : Side::right),
      size_{uniform(min_length_m, max_length_m), 0.0}, skeleton_(side_) {
  size_.breadth_m = size_.length_m * uniform(0.41, 0.48);
  skeleton_ = hand::HandSkeleton(side_, size_);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Kind& kind = kinds[slot];
    habit_rad_[slot] = from_degrees(normal(0.0, 0.5 * kind.bent));
    const double deviation_deg =
        std::max(range_deviation * (kind.high - kind.low), min_range_deviation_deg);
    const auto end_rad = [&](double end_deg) {
      return from_degrees(end_deg + deviation_deg * std::clamp(normal(0.0, 1.0), -1.5, 1.1));
    };
    ranges_[slot] = {kind.low == 0.0 ? 0.0 : end_rad(kind.low), end_rad(kind.high)};
  }
  pad_depth_m_ = uniform(0.004, 0.009);
  pad_behind_tip_m_ = uniform(0.0, 0.007);
  draw_sensors();
  palm_depth_m_ = uniform(0.008, 0.016);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    edge_habit_rad_[slot] = from_degrees(normal(0.0, 0.5 * kinds[slot].bent));
}

double Wearer::clamped(std::size_t slot, double angle_rad) const {
  return std::clamp(angle_rad, ranges_[slot].low_rad, ranges_[slot].high_rad);
}

double Wearer::normal(double mean, double deviation) {
  return std::normal_distribution<double>(mean, deviation)(random_);
}

double Wearer::uniform(double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random_);
}

void Wearer::draw_sensors() {
  truth_.coupling_gains[0] = uniform(-0.15, 0.45);
  truth_.coupling_gains[1] = uniform(-0.40, 0.10);
  // A gap's sensor is stretched when its fingers bend, and that is to be taken off.
  for (std::size_t k = 2; k < hand::couplings.size(); ++k)
    truth_.coupling_gains[k] = uniform(-0.25, 0.05);
  std::vector<SensorAngles> seen;
  const FreeMotion motion(random_(), ranges_);
  for (double time_s = 0.0; time_s < 60.0; time_s += 0.2)
    seen.push_back(lines_of(motion.angles_rad(time_s), truth_));
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Kind& kind = kinds[slot];
    if (kind.gain == 0.0) continue;
    bow_rad_[slot] = from_degrees(uniform(-1.0, 1.0));
    const auto fits = [&](const SensorAngles& lines) {
      const double count = count_of(slot, lines);
      return count > 13.0 && count < 243.0;
    };
    do { // gloves are set so that no sensor is at its end
      truth_.sensors[slot] = {std::max(normal(kind.gain, kind.gain_deviation), 5.0) / 1000.0,
                              normal(kind.offset, kind.offset_deviation)};
    } while (!std::all_of(seen.begin(), seen.end(), fits));
  }
}

double Wearer::count_of(std::size_t slot, const SensorAngles& lines) const {
  const double low = from_degrees(kinds[slot].low);
  const double part = (lines[slot] - low) / (from_degrees(kinds[slot].high) - low);
  // Straight line and parabola, which is bow_rad at the middle of the range and 0 at its ends.
  const double bow = bow_rad_[slot] * 4.0 * part * (1.0 - part);
  const auto [gain, offset] = truth_.sensors[slot];
  return (lines[slot] + bow) / gain + offset;
}

GloveSample Wearer::read(const SensorAngles& angles_rad) {
  const SensorAngles lines = lines_of(angles_rad, truth_);
  GloveSample sample;
  sample.side = side_;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!sensors_22.has(static_cast<Sensor>(slot))) continue;
    const double count = std::round(count_of(slot, lines) + normal(0.0, noise_counts));
    sample.set(static_cast<Sensor>(slot),
               RawCount{static_cast<std::uint16_t>(std::clamp(count, 1.0, 255.0))});
  }
  return sample;
}

SensorAngles Wearer::perform(PoseId id) {
  const hand::CalibrationPose& pose = hand::pose_of(id);
  SensorAngles angles{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const Kind& kind = kinds[slot];
    const hand::AssumedAngle asked = pose.assumed[slot];
    const bool bent = std::abs(asked.angle_rad) > from_degrees(8);
    double angle = from_degrees(normal(kind.relaxed, kind.relaxed_deviation));
    if (asked.known()) {
      const double farther = asked.angle_rad < 0.0 ? -1.0 : 1.0;
      const bool by_feel = bent && asked.by_feel;
      angle = asked.angle_rad + from_degrees(normal(0.0, by_feel ? kind.bent : kind.straight));
      if (by_feel) angle += habit_rad_[slot] + farther * from_degrees(kind.shift);
      if (bent && !by_feel) angle += edge_habit_rad_[slot];
    }
    // Chance leads no farther than a joint goes; calm hands do not lie at 0, but about it.
    const double play_rad = asked.known() ? from_degrees(4) : 0.0;
    angles[slot] =
        std::clamp(angle, ranges_[slot].low_rad - play_rad, ranges_[slot].high_rad + play_rad);
  }
  if (pose.touch) make_touch(id, angles);
  return angles;
}

Eigen::Vector3d Wearer::gap(const hand::Touch& touch, const SensorAngles& angles) const {
  const hand::HandPose pose = skeleton_.pose(joints_of(angles), Eigen::Isometry3d::Identity());
  const Eigen::Vector3d pad(0.0, -pad_depth_m_, pad_behind_tip_m_);
  if (hand::parent_of(touch.with) == Joint::little_metacarpal) {
    const Eigen::Vector3d skin(0.0, -palm_depth_m_, 0.0);
    return pose[Joint::thumb_tip] * pad - pose[touch.with].translation() -
           pose[Joint::little_metacarpal].linear() * skin;
  }
  return pose[Joint::thumb_tip] * pad - pose[touch.with] * pad;
}

double Wearer::gap_m(PoseId pose, const SensorAngles& angles_rad) const {
  const auto& touch = hand::pose_of(pose).touch;
  return touch ? gap(*touch, angles_rad).norm() : 0.0;
}

void Wearer::approach(const hand::Touch& touch, const std::vector<std::size_t>& slots,
                      const Eigen::Vector3d& slip_m, SensorAngles& angles) const {
  const Eigen::Vector3d apart = gap(touch, angles) - slip_m;
  Eigen::Matrix<double, 3, Eigen::Dynamic> slopes(3, static_cast<Eigen::Index>(slots.size()));
  for (std::size_t n = 0; n < slots.size(); ++n) {
    SensorAngles moved = angles;
    moved[slots[n]] += 1e-5;
    slopes.col(static_cast<Eigen::Index>(n)) = (gap(touch, moved) - slip_m - apart) / 1e-5;
  }
  // The shortest way there, damped; joints at an end of their range that would continue stay there,
  // and the others do their part.
  for (int round = 0; round < 3; ++round) {
    const Eigen::Matrix3d square = slopes * slopes.transpose() + 1e-6 * Eigen::Matrix3d::Identity();
    const Eigen::VectorXd step = -0.6 * slopes.transpose() * (square.inverse() * apart);
    SensorAngles next = angles;
    bool stopped = false;
    for (std::size_t n = 0; n < slots.size(); ++n) {
      const auto column = static_cast<Eigen::Index>(n);
      const double wanted = angles[slots[n]] + std::clamp(step[column], -0.3, 0.3);
      next[slots[n]] = clamped(slots[n], wanted);
      if (std::abs(next[slots[n]] - wanted) < 1e-6) continue;
      slopes.col(column).setZero();
      stopped = true;
    }
    if (stopped && round < 2) continue;
    angles = next;
    return;
  }
}

void Wearer::make_touch(PoseId id, SensorAngles& angles) {
  const hand::Touch& touch = *hand::pose_of(id).touch;
  const auto [slots, liked_deg] = joints_for(id);
  const bool palm = slots.size() == 4;
  Eigen::Vector3d slip_m;
  for (double& coordinate : slip_m)
    coordinate = normal(0.0, palm ? palm_slip_deviation_m : slip_deviation_m);
  SensorAngles best = angles;
  double best_gap_m = 1.0;
  for (int attempt = 0; attempt < 40 && best_gap_m > 0.002; ++attempt) {
    SensorAngles now = angles;
    for (std::size_t n = 0; n < slots.size(); ++n)
      now[slots[n]] = clamped(slots[n], from_degrees(normal(liked_deg[n], 8)));
    for (int turn = 0; turn < 60; ++turn)
      approach(touch, slots, slip_m, now);
    const double apart_m = (gap(touch, now) - slip_m).norm();
    if (apart_m >= best_gap_m) continue;
    best = now;
    best_gap_m = apart_m;
  }
  angles = best;
}

hand::JointAngles joints_of(const SensorAngles& angles_rad) noexcept {
  const auto of = [&](Sensor sensor) { return angles_rad[slot_of(sensor)]; };
  const double middle_ring = of(Sensor::middle_ring_abduction);
  hand::JointAngles joints;
  joints.thumb_roll_rad = of(Sensor::thumb_roll);
  joints.thumb_abduction_rad = of(Sensor::thumb_abduction);
  joints.thumb_mcp_flexion_rad = of(Sensor::thumb_mcp);
  joints.thumb_ip_flexion_rad = of(Sensor::thumb_ip);
  joints[Finger::index] = {of(Sensor::index_mcp), of(Sensor::index_middle_abduction),
                           of(Sensor::index_pip), of(Sensor::index_dip)};
  joints[Finger::middle] = {of(Sensor::middle_mcp), 0.0, of(Sensor::middle_pip),
                            of(Sensor::middle_dip)};
  joints[Finger::ring] = {of(Sensor::ring_mcp), -middle_ring, of(Sensor::ring_pip),
                          of(Sensor::ring_dip)};
  joints[Finger::little] = {of(Sensor::little_mcp),
                            -middle_ring - of(Sensor::ring_little_abduction),
                            of(Sensor::little_pip), of(Sensor::little_dip)};
  joints.palm_arch_rad = of(Sensor::palm_arch);
  joints.wrist_pitch_rad = of(Sensor::wrist_pitch);
  joints.wrist_yaw_rad = of(Sensor::wrist_yaw);
  return joints;
}

} // namespace nendo::reference
