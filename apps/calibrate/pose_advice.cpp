#include "calibrate/pose_advice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <nendo/base/units.hpp>

namespace nendo::calibrate {
namespace {

using hand::Finger;
using hand::Joint;

constexpr std::array<std::string_view, sensor_slots> sensor_words{
    "thumb, turned across the palm",
    "thumb, middle joint",
    "thumb, last joint",
    "thumb, away from the index finger",
    "index finger, knuckle",
    "index finger, middle joint",
    "index finger, last joint",
    "index finger, to the side",
    "middle finger, knuckle",
    "middle finger, middle joint",
    "middle finger, last joint",
    "gap of index and middle finger",
    "ring finger, knuckle",
    "ring finger, middle joint",
    "ring finger, last joint",
    "gap of middle and ring finger",
    "little finger, knuckle",
    "little finger, middle joint",
    "little finger, last joint",
    "gap of ring and little finger",
    "arch of the palm",
    "wrist, up and down",
    "wrist, to the sides",
    "no joint",
};
constexpr std::array<std::string_view, hand::finger_count> finger_words{
    "thumb", "index finger", "middle finger", "ring finger", "little finger"};

/// How far a joint may be off before it is named, in addition to twice what wearers deviate: the
/// calibration so far is not exact either.
double doubt_rad(Sensor sensor, Trust trust) noexcept {
  if (is_gap(sensor)) return from_degrees(10.0);
  return from_degrees(trust == Trust::fitted ? 18.0 : 38.0);
}
constexpr double far_pads_m = 0.040;

/// The angle of a joint minus the one that is asked for.
struct Off {
  double by_rad = 0.0;
  double excess_rad = 0.0; ///< positive: it is named
};

class Adviser {
public:
  Adviser(hand::PoseId pose, const hand::JointAngles& live, SensorMask measured, Trust trust)
      : pose_(hand::pose_of(pose)), angles_(hand::sensor_angles_of(live)), measured_(measured),
        trust_(trust) {}

  Off off(Sensor sensor) const noexcept {
    const hand::AssumedAngle& asked = pose_.assumed[index_of(sensor)];
    if (!asked.known() || !measured_.has(sensor)) return {};
    const double by_rad = angles_[index_of(sensor)] - asked.angle_rad;
    return {by_rad, std::abs(by_rad) - 2.0 * asked.deviation_rad - doubt_rad(sensor, trust_)};
  }

  /// Of joints that bend: which way the worst one goes, and where, if it is the only one.
  void bends(Finger finger, std::span<const Sensor> joints,
             std::span<const std::string_view> places) {
    Off worst;
    std::size_t at = 0;
    int wrong = 0, known = 0;
    for (std::size_t joint = 0; joint < joints.size(); ++joint) {
      const Off now = off(joints[joint]);
      known += pose_.assumed[index_of(joints[joint])].known() ? 1 : 0;
      wrong += now.excess_rad > 0.0 ? 1 : 0;
      if (now.excess_rad <= worst.excess_rad) continue;
      worst = now;
      at = joint;
    }
    if (wrong == 0) return;
    const std::string_view what = worst.by_rad < 0.0 ? "bend it more" : "straighten it";
    const bool only = wrong == 1 && known > 1;
    add(finger, std::string(what) + (only ? " " + std::string(places[at]) : ""), worst);
  }
  void fingers() {
    constexpr std::array<std::string_view, 3> places{"at the knuckle", "at the middle joint",
                                                     "at the last joint"};
    for (std::size_t at = 0; at < finger_sensors.size(); ++at)
      bends(static_cast<Finger>(at + 1), finger_sensors[at], places);
    for (std::size_t at = 0; at < gap_sensors.size() && trust_ == Trust::fitted; ++at)
      gap(gap_sensors[at], static_cast<Finger>(at + 1), static_cast<Finger>(at + 2));
  }
  void gap(Sensor sensor, Finger one, Finger other) {
    const Off now = off(sensor);
    if (!(now.excess_rad > 0.0)) return;
    PoseAdvice advice{std::string(in_words(one)) + " and " + std::string(in_words(other)) +
                          (now.by_rad < 0.0 ? ": spread them" : ": close the gap"),
                      {},
                      now.excess_rad};
    advice.fingers[static_cast<std::size_t>(one)] = true;
    advice.fingers[static_cast<std::size_t>(other)] = true;
    found.push_back(std::move(advice));
  }
  void thumb() {
    if (trust_ != Trust::fitted) return;
    constexpr std::array joints{Sensor::thumb_mcp, Sensor::thumb_ip};
    constexpr std::array<std::string_view, 2> places{"at the middle joint", "at the last joint"};
    bends(Finger::thumb, joints, places);
    if (const Off now = off(Sensor::thumb_roll); now.excess_rad > 0.0)
      add(Finger::thumb, now.by_rad < 0.0 ? "turn it in front of the palm" : "turn it to the side",
          now);
    if (const Off now = off(Sensor::thumb_abduction); now.excess_rad > 0.0)
      add(Finger::thumb,
          now.by_rad < 0.0 ? "move it away from the index finger"
                           : "bring it closer to the index finger",
          now);
  }
  void wrist() {
    if (const Off now = off(Sensor::wrist_pitch); now.excess_rad > 0.0)
      found.push_back({now.by_rad < 0.0 ? "wrist: bend it towards the palm"
                                        : "wrist: bend it towards the back of the hand",
                       {},
                       now.excess_rad});
    if (const Off now = off(Sensor::wrist_yaw); now.excess_rad > 0.0 && trust_ == Trust::fitted)
      found.push_back({now.by_rad < 0.0 ? "wrist: turn it towards the thumb"
                                        : "wrist: turn it towards the little finger",
                       {},
                       now.excess_rad});
  }
  /// Pads that shall touch, once joints are as asked.
  void touch(const hand::JointAngles& live, const hand::HandSkeleton& skeleton) {
    if (!pose_.touch || trust_ != Trust::fitted || !found.empty()) return;
    const hand::HandPose pose = skeleton.pose(live, Eigen::Isometry3d::Identity());
    const auto tip = std::find(hand::fingertips.begin(), hand::fingertips.end(), pose_.touch->with);
    const bool palm = tip == hand::fingertips.end();
    const Eigen::Vector3d meets =
        pose[pose_.touch->with] *
        (palm ? Eigen::Vector3d(0.0, -hand::palm_depth_m, 0.0) : Eigen::Vector3d(skeleton.pad()));
    const double gap_m = (pose[Joint::thumb_tip] * skeleton.pad() - meets).norm();
    if (gap_m < far_pads_m) return;
    PoseAdvice advice{"thumb: touch the base of the little finger", {true}, gap_m};
    if (!palm) {
      const auto finger = static_cast<std::size_t>(tip - hand::fingertips.begin());
      advice.text =
          "thumb and " + std::string(finger_words[finger]) + ": bring their tips together";
      advice.fingers[finger] = true;
    }
    found.push_back(std::move(advice));
  }

  std::vector<PoseAdvice> found;

private:
  void add(Finger finger, const std::string& what, const Off& off) {
    PoseAdvice advice{std::string(in_words(finger)) + ": " + what, {}, off.excess_rad};
    advice.fingers[static_cast<std::size_t>(finger)] = true;
    found.push_back(std::move(advice));
  }

  const hand::CalibrationPose& pose_;
  hand::SensorAngles angles_;
  SensorMask measured_;
  Trust trust_;
};

/// Merges advice that three fingers or more have in common.
void merge_alike(std::vector<PoseAdvice>& found) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> alike{
      std::pair{": bend it more", "fingers: bend them more"},
      std::pair{": straighten it", "fingers: straighten them"}};
  for (const auto& [ending, text] : alike) {
    const auto is_alike = [&ending = ending](const PoseAdvice& advice) {
      return !advice.fingers[0] && advice.text.find(ending) != std::string::npos;
    };
    if (std::count_if(found.begin(), found.end(), is_alike) < 3) continue;
    PoseAdvice all{std::string(text), {}, 0.0};
    for (const PoseAdvice& advice : found) {
      if (!is_alike(advice)) continue;
      all.excess_rad = std::max(all.excess_rad, advice.excess_rad);
      for (std::size_t at = 0; at < all.fingers.size(); ++at)
        all.fingers[at] = all.fingers[at] || advice.fingers[at];
    }
    std::erase_if(found, is_alike);
    found.push_back(std::move(all));
  }
}

} // namespace

std::string_view in_words(Sensor sensor) noexcept {
  return sensor_words[index_of(sensor)];
}

std::string_view in_words(Finger finger) noexcept {
  return finger_words[static_cast<std::size_t>(finger)];
}

std::vector<PoseAdvice> advise(hand::PoseId pose, const hand::JointAngles& live,
                               const hand::HandSkeleton& skeleton, SensorMask measured,
                               Trust trust) {
  Adviser adviser(pose, live, measured, trust);
  adviser.fingers();
  adviser.thumb();
  adviser.wrist();
  adviser.touch(live, skeleton);
  merge_alike(adviser.found);
  std::stable_sort(adviser.found.begin(), adviser.found.end(),
                   [](const PoseAdvice& one, const PoseAdvice& other) {
                     return one.excess_rad > other.excess_rad;
                   });
  return std::move(adviser.found);
}

} // namespace nendo::calibrate
