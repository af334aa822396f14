#include "viewer/pointing.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Dense>

#include <nendo/deform/triangles.hpp>

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

namespace {

/// Möller and Trumbore (1997). Returns how far along the ray the triangle is; nothing if the ray
/// misses it.
std::optional<double> distance_to(const Ray& ray, const Vector3d& a, const Vector3d& b,
                                  const Vector3d& c) noexcept {
  const Vector3d ab = b - a, ac = c - a;
  const Vector3d across = ray.along.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0.0) return std::nullopt;
  const Vector3d to = (ray.from - a) / determinant;
  const double u = to.dot(across);
  const Vector3d beside = to.cross(ab);
  const double v = ray.along.dot(beside);
  const double distance = ac.dot(beside);
  constexpr double edge = -1e-12; // shared edges belong to both triangles
  if (!(u >= edge && v >= edge && u + v <= 1.0 - edge && distance > 0.0)) return std::nullopt;
  return distance;
}

} // namespace

Ray ray_at(const render::Camera& camera, const Eigen::Vector2d& pixel, render::Size size) noexcept {
  const Eigen::Matrix4d unproject = camera.projection(1.0 * size.width / size.height).inverse();
  const double x = 2.0 * pixel.x() / size.width - 1.0;
  const double y = 1.0 - 2.0 * pixel.y() / size.height;
  const Vector3d eye = camera.eye();
  const Vector3d far = (unproject * Eigen::Vector4d(x, y, 0.5, 1.0)).hnormalized();
  return {eye, (far - eye).stableNormalized()};
}

std::optional<SurfaceHit> first_hit(const deform::Mesh& mesh, const Ray& ray,
                                    const deform::Points* rest) {
  std::optional<SurfaceHit> hit;
  double nearest = std::numeric_limits<double>::infinity();
  const deform::Points& places = rest != nullptr ? *rest : mesh.vertices;
  deform::for_each_triangle(mesh, places, [&](const deform::Triangle& corners) {
    const Vector3d a = mesh.vertices.col(corners[0]);
    const Vector3d b = mesh.vertices.col(corners[1]);
    const Vector3d c = mesh.vertices.col(corners[2]);
    const auto distance = distance_to(ray, a, b, c);
    if (!distance || *distance >= nearest) return;
    nearest = *distance;
    Vector3d normal = (b - a).cross(c - a).stableNormalized();
    if (normal.dot(ray.along) > 0.0) normal = -normal;
    hit = SurfaceHit{ray.from + nearest * ray.along, normal, corners};
    const Vector3d area = (b - a).cross(c - a);
    const double whole = std::max(area.squaredNorm(), std::numeric_limits<double>::min());
    hit->parts.y() = (hit->at - a).cross(c - a).dot(area) / whole;
    hit->parts.z() = (b - a).cross(hit->at - a).dot(area) / whole;
    hit->parts.x() = 1.0 - hit->parts.y() - hit->parts.z();
  });
  return hit;
}

} // namespace nendo::viewer
