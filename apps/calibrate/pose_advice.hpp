#pragma once
// Compares a hand with the pose that it is asked for, and says in words what to change.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::calibrate {

/// Returns the joint or gap of a sensor in words: "ring finger, middle joint".
std::string_view in_words(Sensor sensor) noexcept;
/// Returns "thumb", "index finger" and so on.
std::string_view in_words(hand::Finger finger) noexcept;

struct PoseAdvice {
  std::string text;                               ///< "ring finger: bend it more"
  std::array<bool, hand::finger_count> fingers{}; ///< which are meant; none: the wrist
  double excess_rad = 0.0; ///< how far the worst joint is beyond what is tolerated
};

/// How far the angles of the live hand can be trusted.
enum class Trust : std::uint8_t {
  typical, ///< no pose has been fitted: only fingers and wrist that are far off are named
  fitted,  ///< the calibration is fitted to this wearer
};

/// Returns what is off by more than wearers deviate from the pose, the worst first. Advice that
/// holds for three fingers or more is one for all. `measured`: sensors that `live` is from.
std::vector<PoseAdvice> advise(hand::PoseId pose, const hand::JointAngles& live,
                               const hand::HandSkeleton& skeleton, SensorMask measured,
                               Trust trust);

} // namespace nendo::calibrate
