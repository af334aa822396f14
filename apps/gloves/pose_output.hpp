#pragma once
// Where `nendo poses` puts its poses: lines on standard output, or a BVH file.

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

  /// The hand that every pose has to be of; nullopt: any.
  virtual std::optional<Side> only_side() const = 0;
  /// A pose that was made of these sensors. Kept until flush().
  virtual Result<void> put(HostTime time, Side side, const hand::HandPose& pose,
                           SensorMask sensors) = 0;
  /// Blocks as long as the disk or the reader does. Error: failed.
  virtual Result<void> flush() = 0;
  /// Flushes and completes; the last call. Error: failed.
  virtual Result<void> finish() = 0;
};

/// Standard output; a reader that has gone is an error from now on, and not the signal SIGPIPE.
std::unique_ptr<PoseOutput> json_pose_output();
/// Errors as BvhFile::create().
Result<std::unique_ptr<PoseOutput>>
bvh_pose_output(const std::string& path, const hand::HandSkeleton& skeleton, double rate_hz);

} // namespace nendo::gloves
