#pragma once
// The calibration of a camera, and its file.

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include <opencv2/core/matx.hpp>

#include <nendo/base/result.hpp>

namespace nendo::markers {

/// A pinhole with OpenCV's distortion. Lengths are in pixels of a picture of this size.
struct CameraModel {
  int width_px = 0;
  int height_px = 0;
  std::array<double, 2> focal_px{};
  std::array<double, 2> centre_px{};
  std::array<double, 5> distortion{}; ///< k1 k2 p1 p2 k3
  double error_px = 0.0;              ///< RMS of the calibration; 0: not calibrated

  cv::Matx33d matrix() const;
};

/// Returns a camera with a view of 60 degrees across and without distortion, for lack of a
/// calibration. Distances are then wrong by as much as the view is.
CameraModel assumed_camera(int width_px, int height_px);

std::string to_toml(const CameraModel& camera);
/// `name` begins the messages. Error: bad_input.
Result<CameraModel> camera_from_toml(std::string_view text, std::string_view name);
/// Error: bad_input.
Result<CameraModel> read_camera(const std::filesystem::path& path);

/// Returns the same camera for pictures of another size and the same shape. Error: usage.
Result<CameraModel> scaled_to(const CameraModel& camera, int width_px, int height_px);

} // namespace nendo::markers
