#pragma once
// Computes how far a point is from a model's surface, by looking at every triangle.

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::test {

struct NearestTriangle {
  double distance = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< by its corners' order
};

inline double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& from,
                                  const Eigen::Vector3d& to) {
  const Eigen::Vector3d way = to - from;
  const double length = way.norm();
  if (length == 0.0) return (p - from).norm();
  const double along = std::clamp((p - from).dot(way / length), 0.0, length);
  return (p - from - along * (way / length)).norm();
}

/// Returns the distance to the edges, or to the plane if that is nearer and the foot of the
/// perpendicular is inside.
inline double distance_to_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                   const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double to_edges = std::min(
      {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
  const Eigen::Vector3d n = (b - a).cross(c - a);
  // The normal of a triangle that is a line consists of rounding errors.
  const bool is_line = n.norm() <= 1e-9 * (b - a).norm() * (c - a).norm();
  const bool inside = !is_line && n.dot((b - a).cross(p - a)) >= 0.0 &&
                      n.dot((c - b).cross(p - b)) >= 0.0 && n.dot((a - c).cross(p - c)) >= 0.0;
  return inside ? std::min(to_edges, std::abs(n.normalized().dot(p - a))) : to_edges;
}

inline NearestTriangle nearest_triangle(const deform::Mesh& model, const Eigen::Vector3d& p) {
  NearestTriangle nearest;
  deform::for_each_triangle(model, [&](const deform::Triangle& corners) {
    const Eigen::Vector3d a = model.vertices.col(corners[0]);
    const Eigen::Vector3d b = model.vertices.col(corners[1]);
    const Eigen::Vector3d c = model.vertices.col(corners[2]);
    const double distance = distance_to_triangle(p, a, b, c);
    if (distance < nearest.distance) nearest = {distance, (b - a).cross(c - a).stableNormalized()};
  });
  return nearest;
}

} // namespace nendo::test
