#include "viewer/pointing.hpp"

#include <algorithm>

#include <Eigen/Geometry>

namespace nendo::viewer {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::optional<Vector2d> pixel_of(const render::Camera& camera, const Vector3d& place,
                                 render::Size size) noexcept {
  const Eigen::Vector4d clip =
      camera.projection(1.0 * size.width / size.height) * place.homogeneous();
  if (!(clip.w() > 0.0)) return std::nullopt;
  const Vector2d in_picture = clip.head<2>() / clip.w();
  return Vector2d((1.0 + in_picture.x()) / 2 * size.width,
                  (1.0 - in_picture.y()) / 2 * size.height);
}

Vector3d way_in_picture(const render::Camera& camera, const Vector3d& place, double dx, double dy,
                        double height) noexcept {
  const Eigen::Matrix3d rows = camera.axes();
  const double depth_m = std::max(0.0, rows.row(2).dot(camera.eye() - place));
  const double metres = 2.0 * camera.tangent() * depth_m / std::max(1.0, height);
  return metres * (dx * rows.row(0) - dy * rows.row(1)).transpose();
}

Vector3d way_by_wheel(const render::Camera& camera, double steps) noexcept {
  constexpr double step_m = 0.01;
  return -step_m * std::clamp(steps, -20.0, 20.0) * camera.axes().row(2).transpose();
}

} // namespace nendo::viewer
