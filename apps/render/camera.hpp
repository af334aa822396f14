#pragma once
// A camera on an orbit about a point.

#include <optional>
#include <span>
#include <string_view>

#include <Eigen/Core>

namespace nendo::render {

/// A direction of view in degrees. Azimuth 0 looks from +z, the operator's side, which models face;
/// azimuth 90 looks from +x; elevation 90 looks from above.
struct View {
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
  bool operator==(const View&) const = default;
};

/// Parses front, back, left, right, side, top, or "AZ,EL" in degrees. Returns nullopt if the text
/// is something else, or if |AZ| exceeds 360 or |EL| exceeds 90.
std::optional<View> view_named(std::string_view text) noexcept;

struct Camera {
  Eigen::Vector3d target = Eigen::Vector3d::Zero(); ///< metres
  double distance_m = 3.0;                          ///< from the target
  View view;
  double field_of_view_deg = 24.0; ///< angle of the picture's height
  /// Where the target is in the picture, as a part of half its width: 0 is the middle, 1 the right
  /// edge. The picture is shifted as a whole, without distortion, if something covers its left.
  double centre = 0.0;

  static constexpr double min_distance_m = 0.05;
  static constexpr double max_distance_m = 50.0;

  /// Returns an orthonormal matrix whose rows point to the picture's right, up, and towards the
  /// camera.
  Eigen::Matrix3d axes() const noexcept;
  Eigen::Vector3d eye() const noexcept;
  /// Returns half the picture's height at a distance of 1.
  double tangent() const noexcept;
  /// Returns the matrix from world coordinates to OpenGL's clip coordinates. aspect: width /
  /// height.
  Eigen::Matrix4d projection(double aspect) const noexcept;

  /// Turn and shift the camera by the pixels that the mouse moved, in a window that is `height`
  /// pixels high. Positive steps of zoom() bring the camera closer.
  void orbit(double dx, double dy) noexcept;
  void pan(double dx, double dy, double height) noexcept;
  void zoom(double steps) noexcept;
  bool operator==(const Camera&) const = default;
};

/// Returns a camera that has all the points in the middle of its picture. `margin` is the part of
/// the picture's half size that stays free. Points that are not finite do not count.
Camera framing(std::span<const Eigen::Vector3f> points, View view, double aspect,
               double margin = 0.06);

} // namespace nendo::render
