#pragma once
// Simulated hands that work on clay or carry parts: their wrists move, and their fingers bend, by a
// plan for the model before them.

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/flow/wrist_path.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::motions {

/// What a hand does. A left hand helps the right one, and can do it alone.
enum class KneadTask : std::uint8_t {
  press, ///< flattens the model on its table with the palm, turned from press to press; by turns
  knead, ///< thumbs it into a bowl; left: holds the wall from outside
  grip,  ///< pinches it with thumb and index finger, and pulls an ear; left: on the other side
  carry, ///< takes its upper part by the side, lifts it, turns it round, and presses it on again
  bore,  ///< goes down through its middle to the table with the thumb; by turns
  cut,   ///< draws a wire through it, below the upper part, from 0.8 s to 2.5 s, and then does that
  slice, ///< the same with a knife, which one hand draws alone
};
inline constexpr std::array knead_tasks{KneadTask::press, KneadTask::knead, KneadTask::grip,
                                        KneadTask::carry, KneadTask::bore,  KneadTask::cut,
                                        KneadTask::slice};
std::string_view name_of(KneadTask task) noexcept;

/// The motion: it begins and ends beside the model, and the hand then stays there.
class KneadingHand {
public:
  /// Plans the motion. The model's longest side is `model_size_m` on the stage. Error: bad_input,
  /// if the model has no size. The same arguments give the same motion. Allocates.
  static Result<KneadingHand> make(const deform::Mesh& model, const hand::HandSkeleton& skeleton,
                                   KneadTask task, double model_size_m);

  /// Returns the joint angles at a time since the start; times before it, and such as are not
  /// finite, count as 0. Any thread, wait-free.
  hand::JointAngles angles(double time_s) const noexcept;
  /// Returns the sensors' angles of a glove at that time; joint_angles() turns them into
  /// angles(time_s).
  hand::SensorAngles sensor_angles(double time_s) const noexcept;
  const std::shared_ptr<const flow::WristPath>& wrist() const noexcept { return wrist_; }
  double length_s() const noexcept { return wrist_->length_s(); }

private:
  KneadingHand() = default;

  std::shared_ptr<const std::vector<hand::JointAngles>> keys_;
  std::shared_ptr<const flow::WristPath> wrist_;
};

} // namespace nendo::motions
