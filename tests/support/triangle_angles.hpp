#pragma once
// How fair the triangles of a mesh are.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/triangles.hpp>

namespace nendo::test {

/// Returns the least angle of each triangle, in degrees, the smallest first.
inline std::vector<double> min_angles(const deform::Mesh& mesh) {
  std::vector<double> angles;
  deform::for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    double least = 180.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d at = mesh.vertices.col(corners[k]);
      const Eigen::Vector3d a = mesh.vertices.col(corners[(k + 1) % 3]) - at;
      const Eigen::Vector3d b = mesh.vertices.col(corners[(k + 2) % 3]) - at;
      least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi);
    }
    angles.push_back(least);
  });
  std::sort(angles.begin(), angles.end());
  return angles;
}

} // namespace nendo::test
