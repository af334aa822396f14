#pragma once
// A camera on an orbit about a point.

#include <optional>
#include <span>
#include <string_view>

#include <Eigen/Core>

namespace nendo::viewer {

/// A way of looking: azimuth 0 from +z (the operator's side, which models face), 90 from +x;
/// elevation 90 from above. Degrees.
struct View {
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
};

/// front, back, left, right, side, top, or "AZ,EL" in degrees. nullopt if it is not that, or not
/// within 360 and 90.
std::optional<View> view_named(std::string_view text) noexcept;

struct Camera {
  Eigen::Vector3d target = Eigen::Vector3d::Zero(); ///< metres
  double distance_m = 3.0;                          ///< from the target
  View view;
  double field_of_view_deg = 24.0; ///< of the picture's height

  static constexpr double least_distance_m = 0.05;
  static constexpr double most_distance_m = 50.0;

  /// Rows: to the picture's right, up, and towards the camera. Orthonormal.
  Eigen::Matrix3d axes() const noexcept;
  Eigen::Vector3d eye() const noexcept;
  /// Half the picture's height at a distance of 1.
  double tangent() const noexcept;
  /// World to clip coordinates as OpenGL has them. aspect: width / height.
  Eigen::Matrix4d projection(double aspect) const noexcept;

  /// Turns by the pixels of a mouse's way, in a window that is `height` pixels high.
  void orbit(double dx, double dy) noexcept;
  void pan(double dx, double dy, double height) noexcept;
  void zoom(double steps) noexcept;
};

/// A camera that has all the points in its picture, with `margin` of its half size to spare, and
/// what they take up in the middle. Points that are not finite do not count.
Camera framing(std::span<const Eigen::Vector3f> points, View view, double aspect,
               double margin = 0.06);

} // namespace nendo::viewer
