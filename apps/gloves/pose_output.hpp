#pragma once
// The outputs of `nendo poses`: lines on standard output, or a BVH file.

#include <memory>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::gloves {

class PoseOutput {
public:
  PoseOutput() = default;
  PoseOutput(const PoseOutput&) = delete;
  PoseOutput& operator=(const PoseOutput&) = delete;
  virtual ~PoseOutput() = default;

  /// Returns the hand of which every pose must be, or nullopt if any hand will do.
  virtual std::optional<Side> only_side() const = 0;
  /// Takes a pose that was made of these angles, which these sensors measured, but for those that
  /// were left out. Keeps it until
  /// flush(), which it calls itself when much is kept; blocks then.
  virtual Result<void> put(HostTime time, Side side, const hand::HandPose& pose,
                           const hand::JointAngles& angles, SensorMask sensors,
                           SensorMask left_out) = 0;
  /// Writes the kept poses. Blocks as long as the disk or the reader does. Error: failed.
  virtual Result<void> flush() = 0;
  /// Flushes and completes the output. Must be the last call. Error: failed.
  virtual Result<void> finish() = 0;
};

/// Writes a JSON object in a line for each pose to standard output. Its keys are time_s (host
/// clock), hand ("left" or "right") and joints. joints has OpenXR's names in OpenXR's order, each
/// with position_m [x, y, z] and orientation_xyzw, a unit quaternion whose w is not negative. The
/// first pose of each glove has also the key angles, with what angle_sources_json() returns. A pose
/// with estimated angles has the key deviations_deg: by the name of each of these angles, one
/// standard deviation (hand::angle_deviations()). Where sensors are stuck, the key left_out has
/// their names.
std::unique_ptr<PoseOutput> json_pose_output();
/// Writes a BVH file. Fails as BvhFile::create() does.
Result<std::unique_ptr<PoseOutput>>
bvh_pose_output(const std::string& path, const hand::HandSkeleton& skeleton, double rate_hz);

} // namespace nendo::gloves
