#include "calibrate/practice_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

#include "calibrate/demonstration.hpp"

namespace nendo::calibrate {
namespace {

/// The range of each joint in a free motion, degrees: the usual ranges of motion.
struct Reach {
  Sensor sensor;
  double min_deg, max_deg;
};
constexpr std::array<Reach, 22> reaches{{
    {Sensor::thumb_roll, 0, 75},
    {Sensor::thumb_mcp, 0, 58},
    {Sensor::thumb_ip, 0, 80},
    {Sensor::thumb_abduction, 0, 50},
    {Sensor::index_mcp, 0, 90},
    {Sensor::index_pip, 0, 103},
    {Sensor::index_dip, 0, 75},
    {Sensor::middle_mcp, 0, 90},
    {Sensor::middle_pip, 0, 103},
    {Sensor::middle_dip, 0, 75},
    {Sensor::index_middle_abduction, 0, 22},
    {Sensor::ring_mcp, 0, 90},
    {Sensor::ring_pip, 0, 103},
    {Sensor::ring_dip, 0, 75},
    {Sensor::middle_ring_abduction, 0, 18},
    {Sensor::little_mcp, 0, 90},
    {Sensor::little_pip, 0, 103},
    {Sensor::little_dip, 0, 75},
    {Sensor::ring_little_abduction, 0, 22},
    {Sensor::palm_arch, 0, 20},
    {Sensor::wrist_pitch, -60, 70},
    {Sensor::wrist_yaw, -30, 20},
}};

/// The standard's distributions differ between libraries; the engine itself does not.
double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

/// About normal, of a deviation of 1, never beyond 3.
double scatter(std::mt19937& random) {
  return 2.0 *
         (uniform(random, -0.5, 0.5) + uniform(random, -0.5, 0.5) + uniform(random, -0.5, 0.5));
}

double smooth(double part) noexcept {
  const double p = std::clamp(part, 0.0, 1.0);
  return p * p * (3.0 - 2.0 * p);
}

hand::HandSkeleton stranger(std::mt19937& random) {
  hand::HandSize size;
  const double by = uniform(random, 0.92, 1.08);
  size.length_m *= by;
  size.breadth_m *= by;
  return hand::HandSkeleton(Side::right, size);
}

} // namespace

PracticeHand::PracticeHand(std::uint32_t seed, std::optional<double> hold_s)
    : hold_s_(hold_s), random_(seed), ids_(hand::full_takes().begin(), hand::full_takes().end()) {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    gains_[slot] = uniform(random_, 0.88, 1.12);
    offsets_rad_[slot] = from_degrees(uniform(random_, 1.0, 8.0));
  }
  const hand::HandSkeleton skeleton = stranger(random_); // a left hand's angles are the same
  for (const hand::PoseId id : ids_) {
    hand::SensorAngles angles = sensor_angles_of(demonstrated_angles(id, skeleton));
    const hand::CalibrationPose& pose = hand::pose_of(id);
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      // Where nothing is asked, the joint is anywhere near; pads that touch hold a joint closely.
      const double asked_rad = pose.assumed[slot].deviation_rad;
      const double free_rad = from_degrees(pose.touch ? 1.0 : 4.0);
      // A flat hand and a fist that are farther off than usual would make later poses implausible.
      const double deviations = std::clamp(0.6 * scatter(random_), -1.0, 1.0);
      angles[slot] += deviations * (asked_rad > 0.0 ? asked_rad : free_rad);
    }
    poses_.push_back(angles);
  }
  keep_from_ends();
  from_ = now_ = free_motion(0.0);
}

/// A sensor at an end of its range keeps a pose from being taken: where one would come
/// there, the glove's gain is less.
void PracticeHand::keep_from_ends() {
  constexpr double margin_counts = 6.0;
  constexpr CountScale counts{};
  const hand::Calibration typical = hand::default_calibration(counts);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& [gain, offset] = typical.sensors[slot];
    const double min_rad = gain * (margin_counts - offset) - offsets_rad_[slot];
    const double max_rad = gain * (counts.max_count - margin_counts - offset) - offsets_rad_[slot];
    for (const hand::SensorAngles& pose : poses_) {
      const double end_rad = pose[slot] > 0.0 ? max_rad : min_rad;
      if (gain > 0.0 && std::abs(gains_[slot] * pose[slot]) > std::abs(end_rad))
        gains_[slot] = end_rad / pose[slot];
    }
  }
}

hand::SensorAngles PracticeHand::free_motion(double time_s) const {
  constexpr double period_s = 2.6;
  hand::SensorAngles angles{};
  for (std::size_t n = 0; n < reaches.size(); ++n) {
    const Reach& reach = reaches[n];
    // Fingers go together; the thumb, the gaps and the wrist at other times.
    const std::size_t slot = index_of(reach.sensor);
    const std::size_t finger = slot / 4;
    const bool flexes = slot >= 4 && slot < 20 && slot % 4 != 3;
    const double phase =
        flexes ? 0.02 * static_cast<double>(finger) : 0.13 * static_cast<double>(n);
    const double bend = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (time_s / period_s - phase));
    angles[slot] = from_degrees(reach.min_deg + bend * (reach.max_deg - reach.min_deg));
  }
  return angles;
}

int PracticeHand::wanted(double time_s) noexcept {
  int step = asked_.load();
  if (hold_s_) {
    const double round_s = std::fmod(time_s, free_motion_s + pose_count() * *hold_s_);
    if (round_s >= free_motion_s)
      step += 1 + static_cast<int>((round_s - free_motion_s) / *hold_s_);
  }
  return std::clamp(step, 0, pose_count() + 1);
}

hand::SensorAngles PracticeHand::at(double time_s) {
  const int step = wanted(time_s);
  if (step != shown_.load()) {
    from_ = now_;
    turned_s_ = time_s;
    shown_ = step;
  }
  // After the last pose the hand moves freely again, which shows what the calibration has made.
  const bool poses = step >= 1 && step <= pose_count();
  const hand::SensorAngles to =
      poses ? poses_[static_cast<std::size_t>(step - 1)] : free_motion(time_s);
  const double part = turned_s_ == 0.0 && step == 0 ? 1.0 : smooth((time_s - turned_s_) / turn_s);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    now_[slot] = from_[slot] + part * (to[slot] - from_[slot]);
  hand::SensorAngles worn{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    worn[slot] = gains_[slot] * now_[slot] + offsets_rad_[slot];
  return worn;
}

std::string PracticeHand::in_words(int step) const {
  if (step <= 0) return "bends and stretches every joint";
  if (step > pose_count()) return "every pose was held; it moves freely";
  return "pose " + std::to_string(step) + " of " + std::to_string(pose_count()) + ": " +
         std::string(hand::pose_of(ids_[static_cast<std::size_t>(step - 1)]).name);
}

} // namespace nendo::calibrate
