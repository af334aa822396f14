#include "render/camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>
#include <nendo/base/units.hpp>

#include "render/exact_trig.hpp"

namespace nendo::render {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

std::optional<View> view_named(std::string_view text) noexcept {
  if (text == "front") return View{0, 0};
  if (text == "back") return View{180, 0};
  if (text == "side" || text == "right") return View{90, 0};
  if (text == "left") return View{-90, 0};
  if (text == "top") return View{0, 90};
  const auto azimuth = number_in<double>(cut(text, ','));
  const auto elevation = number_in<double>(text);
  if (!azimuth || !elevation || !(std::abs(*azimuth) <= 360.0 && std::abs(*elevation) <= 90.0))
    return std::nullopt;
  return View{*azimuth, *elevation};
}

Matrix3d Camera::axes() const noexcept {
  const double azimuth = from_degrees(view.azimuth_deg);
  const double elevation = from_degrees(view.elevation_deg);
  const double sa = exact_sine(azimuth);
  const double ca = exact_cosine(azimuth);
  const double se = exact_sine(elevation);
  const double ce = exact_cosine(elevation);
  Matrix3d rows;
  rows << ca, 0.0, -sa, -sa * se, ce, -ca * se, sa * ce, se, ca * ce;
  return rows;
}

Vector3d Camera::eye() const noexcept {
  return target + distance_m * axes().row(2).transpose();
}

double Camera::tangent() const noexcept {
  const double half = from_degrees(field_of_view_deg) / 2;
  return exact_sine(half) / exact_cosine(half);
}

Matrix4d Camera::projection(double aspect) const noexcept {
  const double near = std::max(0.01, distance_m - 4.0);
  const double far = distance_m + 8.0;
  Matrix4d eye_of_world = Matrix4d::Identity();
  eye_of_world.topLeftCorner<3, 3>() = axes();
  eye_of_world.topRightCorner<3, 1>() = -axes() * eye();
  Matrix4d clip_of_eye = Matrix4d::Zero();
  clip_of_eye(0, 0) = 1.0 / (tangent() * aspect);
  clip_of_eye(0, 2) = -centre; // times w, which is -z
  clip_of_eye(1, 1) = 1.0 / tangent();
  clip_of_eye(2, 2) = (far + near) / (near - far);
  clip_of_eye(2, 3) = 2.0 * far * near / (near - far);
  clip_of_eye(3, 2) = -1.0;
  return clip_of_eye * eye_of_world;
}

void Camera::orbit(double dx, double dy) noexcept {
  view.azimuth_deg = std::remainder(view.azimuth_deg - 0.35 * dx, 360.0);
  view.elevation_deg = std::clamp(view.elevation_deg + 0.35 * dy, -90.0, 90.0);
}

void Camera::pan(double dx, double dy, double height) noexcept {
  const double metres = 2.0 * tangent() * distance_m / std::max(1.0, height);
  const Matrix3d rows = axes();
  target += metres * (-dx * rows.row(0) + dy * rows.row(1)).transpose();
  target = target.cwiseMax(-10.0).cwiseMin(10.0);
}

void Camera::zoom(double steps) noexcept {
  distance_m = std::clamp(distance_m * std::pow(0.9, std::clamp(steps, -20.0, 20.0)),
                          min_distance_m, max_distance_m);
}

Camera framing(std::span<const Eigen::Vector3f> points, View view, double aspect, double margin) {
  Camera camera;
  camera.view = view;
  const Matrix3d rows = camera.axes();
  const double across = camera.tangent() * (1.0 - margin);
  const Eigen::Vector2d tangents(across * aspect, across);
  // In axes of the camera, a point at height z above the target's plane is in the picture if
  // |x| <= t (distance - z). So each side asks for a least x_side + t z; two sides make the middle
  // and the distance.
  Vector3d middle = Vector3d::Zero();
  double distance = -std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 2; ++axis) {
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const auto& point : points) {
      const Vector3d seen = rows * point.cast<double>();
      if (!seen.allFinite()) continue;
      most = std::max(most, seen[axis] + tangents[axis] * seen.z());
      least = std::min(least, seen[axis] - tangents[axis] * seen.z());
    }
    if (!std::isfinite(most) || !std::isfinite(least)) return camera; // no points
    middle[axis] = (most + least) / 2;
    distance = std::max(distance, (most - least) / (2 * tangents[axis]));
  }
  // `distance` is from the plane z = 0; the target is put amid the points.
  double nearest = -std::numeric_limits<double>::infinity();
  double farthest = -nearest;
  for (const auto& point : points) {
    const double z = rows.row(2).dot(point.cast<double>());
    if (!std::isfinite(z)) continue;
    nearest = std::max(nearest, z);
    farthest = std::min(farthest, z);
  }
  middle.z() = (nearest + farthest) / 2;
  camera.target = rows.transpose() * middle;
  camera.distance_m =
      std::clamp(distance - middle.z(), Camera::min_distance_m, Camera::max_distance_m);
  return camera;
}

} // namespace nendo::render
