#pragma once
// Closed models with a concave top and bottom, each one face.

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/triangles.hpp>

#include "support/random_polygons.hpp"

namespace nendo::test {

/// Returns a prism of height 1 on a polygon, which is multiplied by `scale`. Bridges get no walls.
inline deform::Mesh prism(const GridPolygon& polygon, double scale) {
  deform::Mesh mesh;
  const auto points = static_cast<std::uint32_t>(polygon.points.size());
  mesh.vertices.resize(3, 2 * static_cast<Eigen::Index>(points));
  for (std::uint32_t at = 0; at < points; ++at)
    for (const std::uint32_t up : {0U, 1U})
      mesh.vertices.col(at + up * points) << scale * static_cast<double>(polygon.points[at][0]),
          scale * static_cast<double>(polygon.points[at][1]), static_cast<double>(up);
  const auto add = [&](const std::vector<std::uint32_t>& corners) {
    mesh.face_corners.insert(mesh.face_corners.end(), corners.begin(), corners.end());
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
  };
  std::vector<std::uint32_t> top = polygon.corners;
  for (std::uint32_t& corner : top)
    corner += points;
  add(top);
  add({polygon.corners.rbegin(), polygon.corners.rend()});
  const std::size_t count = polygon.corners.size();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ways;
  for (std::size_t at = 0; at < count; ++at)
    ways.emplace_back(polygon.corners[at], polygon.corners[(at + 1) % count]);
  for (const auto& [from, to] : ways)
    if (std::find(ways.begin(), ways.end(), std::pair(to, from)) == ways.end())
      add({from, to, to + points, from + points});
  return mesh;
}

/// Returns an L of area 5, whose first corner does not see its other arm.
inline deform::Mesh l_prism() {
  return prism(polygon_of({{3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}, {0, 0}}), 1.0);
}

/// Returns the area of the surface.
inline double area_of(const deform::Mesh& mesh) {
  double area = 0.0;
  deform::for_each_triangle(mesh, [&](const deform::Triangle& at) {
    const Eigen::Vector3d from = mesh.vertices.col(at[0]);
    area += 0.5 * (mesh.vertices.col(at[1]) - from).cross(mesh.vertices.col(at[2]) - from).norm();
  });
  return area;
}

} // namespace nendo::test
