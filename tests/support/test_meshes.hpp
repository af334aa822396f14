#pragma once
// Models of which every vertex is known.

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <random>

#include <nendo/deform/mesh.hpp>

namespace nendo::test {

inline void add_face(deform::Mesh& mesh, std::initializer_list<std::uint32_t> corners) {
  mesh.face_corners.insert(mesh.face_corners.end(), corners);
  mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
}

/// Returns cells by cells quads in the plane z = 0, from the origin to (size, size, 0).
inline deform::Mesh grid(std::uint32_t cells, double size) {
  deform::Mesh mesh;
  const std::uint32_t side = cells + 1;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(side) * side);
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column)
      mesh.vertices.col(row * side + column) << size * column / cells, size * row / cells, 0.0;
  for (std::uint32_t row = 0; row < cells; ++row)
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t at = row * side + column;
      add_face(mesh, {at, at + 1, at + side + 1, at + side});
    }
  return mesh;
}

/// Returns a sphere about the origin: rings of quads between two fans of triangles, which face
/// outwards.
inline deform::Mesh sphere(std::uint32_t rings, std::uint32_t segments, double radius) {
  deform::Mesh mesh;
  mesh.vertices.resize(3, 2 + static_cast<Eigen::Index>(rings) * segments);
  mesh.vertices.col(0) << 0.0, 0.0, radius;
  mesh.vertices.col(1) << 0.0, 0.0, -radius;
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t segment = 0; segment < segments; ++segment) {
      const double polar = std::numbers::pi * (ring + 1) / (rings + 1);
      const double turn = 2.0 * std::numbers::pi * segment / segments;
      mesh.vertices.col(2 + ring * segments + segment) << radius * std::sin(polar) * std::cos(turn),
          radius * std::sin(polar) * std::sin(turn), radius * std::cos(polar);
    }
  for (std::uint32_t segment = 0; segment < segments; ++segment) {
    const std::uint32_t next = (segment + 1) % segments;
    const std::uint32_t last = 2 + (rings - 1) * segments;
    add_face(mesh, {0, 2 + segment, 2 + next});
    for (std::uint32_t from = 2; from < last; from += segments)
      add_face(mesh,
               {from + segment, from + segments + segment, from + segments + next, from + next});
    add_face(mesh, {last + segment, 1, last + next});
  }
  return mesh;
}

/// Returns random points, evenly distributed in a cube about the origin.
inline deform::Points random_points(std::mt19937& random, Eigen::Index count, double half_edge) {
  std::uniform_real_distribution<double> coordinate(-half_edge, half_edge);
  deform::Points points(3, count);
  for (double& value : points.reshaped())
    value = coordinate(random);
  return points;
}

} // namespace nendo::test
