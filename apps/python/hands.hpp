#pragma once
// Angles and poses of hands as arrays.

#include <array>
#include <optional>
#include <vector>

#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/skeleton.hpp>

#include "python/arrays.hpp"

namespace nendo::python {

/// A skeleton with its size.
struct Skeleton {
  hand::HandSize size;
  hand::HandSkeleton bones;
};

/// A calibration with its file, if it has one.
struct CalibrationFile {
  hand::WearerCalibration wearer;
  std::optional<std::string> path;
};

/// The joint poses of a hand, (26, 4, 4).
using JointMatrices = std::array<double, hand::joint_count * 16>;

/// Writes the joint angles in the order of hand::angle_names.
inline void write_angles(const hand::JointAngles& angles, double* out) noexcept {
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    out[at] = angles[hand::angle_at(at)];
}
/// Writes the poses of all joints, 16 numbers each.
inline void write_joints(const hand::HandPose& pose, double* out) {
  for (std::size_t joint = 0; joint < hand::joint_count; ++joint)
    write_motion(pose.joints[joint], out + 16 * joint);
}

} // namespace nendo::python
