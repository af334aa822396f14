#pragma once
// Where a bracelet is, from the markers that a camera sees.

#include <array>
#include <optional>
#include <span>

#include <opencv2/core/matx.hpp>

#include <nendo/base/side.hpp>

#include "markers/camera_model.hpp"
#include "markers/marker_detector.hpp"

namespace nendo::markers {

/// The frame of the bracelet in that of the camera, as OpenCV has it: x to the right of the
/// picture, y down, z away from the camera; metres.
struct BraceletPose {
  cv::Matx33d turn = cv::Matx33d::eye(); ///< bracelet to camera
  cv::Vec3d position_m;
  double error_px = 0.0; ///< RMS of the corners
  int markers = 0;       ///< the number of markers that were used
};

/// Markers below this number are not trusted: a single one is often seen in other things.
inline constexpr int min_markers = 2;
/// A larger RMS error is of wrong markers, or of a bracelet that is not folded as it should be.
inline constexpr double max_error_px = 2.0;

/// Returns the pose of a side's bracelet, or nothing if too few markers are seen, or they
/// contradict one another. Of two poses that explain the picture about equally well, it is the one
/// nearer to `previous`, if that is given.
std::optional<BraceletPose> find_bracelet(Side side, std::span<const Marker> markers,
                                          const CameraModel& camera,
                                          const std::optional<BraceletPose>& previous = {});

/// A pose with the axes of the stage, as the OSC inlet wants it: the camera is before the operator,
/// upright, and looks at them, so x is to the operator's right, y up, and z towards the operator.
struct StagePose {
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{};
};
StagePose to_stage(const BraceletPose& pose);

} // namespace nendo::markers
