#include "motions/surface_walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <nendo/deform/triangles.hpp>

namespace nendo::motions {
namespace {

using Eigen::Vector3d;

Vector3d mix(const std::array<Vector3d, 3>& of, const std::array<double, 3>& weights) noexcept {
  return weights[0] * of[0] + weights[1] * of[1] + weights[2] * of[2];
}

} // namespace

std::array<double, 3> nearest_weights(const SurfaceTriangle& triangle,
                                      const Vector3d& place) noexcept {
  const auto& [a, b, c] = triangle.corners;
  const Vector3d u = b - a;
  const Vector3d v = c - a;
  const Vector3d w = place - a;
  // The foot of the perpendicular, by the normal equations of a + s u + t v; if it is outside, the
  // nearest point is on an edge.
  const double uu = u.squaredNorm();
  const double uv = u.dot(v);
  const double vv = v.squaredNorm();
  const double determinant = uu * vv - uv * uv;
  if (determinant > 1e-12 * uu * vv) {
    const double s = (vv * u.dot(w) - uv * v.dot(w)) / determinant;
    const double t = (uu * v.dot(w) - uv * u.dot(w)) / determinant;
    if (s >= 0.0 && t >= 0.0 && s + t <= 1.0) return {1.0 - s - t, s, t};
  }
  std::array<double, 3> best{1.0, 0.0, 0.0};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t from = 0; from < 3; ++from) {
    const std::size_t to = (from + 1) % 3;
    const Vector3d edge = triangle.corners[to] - triangle.corners[from];
    const double along = edge.dot(place - triangle.corners[from]);
    const double part = along > 0.0 ? std::min(along / edge.squaredNorm(), 1.0) : 0.0;
    const double distance = (triangle.corners[from] + part * edge - place).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best = {};
    best[from] = 1.0 - part;
    best[to] = part;
  }
  return best;
}

SurfacePatch::SurfacePatch(const deform::Mesh& model, const deform::Points& normals,
                           double units_per_metre, const Vector3d& centre_m, double margin_m) {
  const auto triangle_of = [&](const std::array<std::uint32_t, 3>& corners) {
    SurfaceTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] = model.vertices.col(corners[k]) / units_per_metre;
      triangle.normals[k] = normals.col(corners[k]);
    }
    return triangle;
  };
  const auto ball_of = [](const SurfaceTriangle& triangle) {
    const auto& [a, b, c] = triangle.corners;
    const Vector3d centre = (a + b + c) / 3.0;
    return Ball{centre, std::max({(a - centre).norm(), (b - centre).norm(), (c - centre).norm()})};
  };
  double nearest_m = std::numeric_limits<double>::infinity();
  deform::for_each_triangle(model, [&](const auto& corners) {
    const Vector3d first = model.vertices.col(corners[0]) / units_per_metre;
    nearest_m = std::min(nearest_m, (first - centre_m).norm());
  });
  deform::for_each_triangle(model, [&](const auto& corners) {
    const SurfaceTriangle triangle = triangle_of(corners);
    const Ball ball = ball_of(triangle);
    if ((ball.centre_m - centre_m).norm() - ball.radius_m > nearest_m + margin_m) return;
    triangles_.push_back(triangle);
    balls_.push_back(ball);
  });
}

std::optional<SurfacePoint> SurfacePatch::nearest(const Vector3d& to_m) const {
  std::optional<SurfacePoint> best;
  double min_m = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    if ((balls_[k].centre_m - to_m).norm() - balls_[k].radius_m >= min_m) continue;
    const auto weights = nearest_weights(triangles_[k], to_m);
    const Vector3d position_m = mix(triangles_[k].corners, weights);
    const double distance_m = (position_m - to_m).norm();
    if (!(distance_m < min_m)) continue;
    min_m = distance_m;
    best = {position_m, mix(triangles_[k].normals, weights).stableNormalized()};
  }
  return best;
}

std::vector<SurfacePoint> walk(const SurfacePatch& patch, const Vector3d& start_m,
                               const Vector3d& direction, double length_m, double step_m) {
  std::vector<SurfacePoint> way;
  auto at = patch.nearest(start_m);
  if (!at) return way;
  way.push_back(*at);
  const auto steps = static_cast<int>(std::ceil(length_m / step_m - 1e-9));
  for (int step = 0; step < steps; ++step) {
    const Vector3d along = direction - direction.dot(at->normal) * at->normal;
    if (along.norm() < 1e-3 * direction.norm()) break; // the surface has turned across the way
    at = patch.nearest(at->position_m + length_m / steps * along.normalized());
    way.push_back(*at);
  }
  return way;
}

} // namespace nendo::motions
