#pragma once
// A sphere of nearly even triangles.

#include <cmath>
#include <cstdint>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/subdivision.hpp>

namespace nendo::reference {

/// Returns an icosahedron, each of whose triangles has been cut into four `level` times, about the
/// origin: 10 * 4^level + 2 vertices. Faces look outwards.
inline deform::Mesh icosphere(int level, double radius) {
  const double golden = (1.0 + std::sqrt(5.0)) / 2.0;
  deform::Mesh mesh;
  mesh.vertices.resize(3, 12);
  Eigen::Index at = 0;
  for (const double one : {-1.0, 1.0})
    for (const double long_side : {-golden, golden}) {
      mesh.vertices.col(at++) << one, long_side, 0.0;
      mesh.vertices.col(at++) << 0.0, one, long_side;
      mesh.vertices.col(at++) << long_side, 0.0, one;
    }
  // Neighbours are 2 apart. Each three of them are a face.
  const auto is_edge = [&](Eigen::Index a, Eigen::Index b) {
    return std::abs((mesh.vertices.col(a) - mesh.vertices.col(b)).norm() - 2.0) < 1e-9;
  };
  for (Eigen::Index a = 0; a < 12; ++a)
    for (Eigen::Index b = a + 1; b < 12; ++b)
      for (Eigen::Index c = b + 1; c < 12; ++c) {
        if (!is_edge(a, b) || !is_edge(b, c) || !is_edge(a, c)) continue;
        const Eigen::Vector3d first = mesh.vertices.col(a);
        const bool outwards = first.dot(mesh.vertices.col(b).cross(mesh.vertices.col(c))) > 0.0;
        for (const Eigen::Index corner : {a, outwards ? b : c, outwards ? c : b})
          mesh.face_corners.push_back(static_cast<std::uint32_t>(corner));
        mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
      }
  for (int finer = 0; finer < level; ++finer)
    mesh = deform::subdivide(mesh).mesh;
  mesh.vertices.colwise().normalize();
  mesh.vertices *= radius;
  return mesh;
}

} // namespace nendo::reference
