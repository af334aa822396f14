#pragma once
// Counts pairs of triangles that cut each other: an edge of one goes through the inside of the
// other. Two that share an edge are not looked at, and of two that share a corner only the edges
// opposite to it. In double, without exact predicates: what only touches may count or not.

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::test {

using Corners = std::array<std::uint32_t, 3>;

/// Six times the volume of the tetrahedron.
inline double turn_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) {
  return (b - a).dot((c - a).cross(d - a));
}

inline bool edge_cuts(const deform::Points& at, std::uint32_t from, std::uint32_t to,
                      const Corners& face) {
  const Eigen::Vector3d p = at.col(from);
  const Eigen::Vector3d q = at.col(to);
  const Eigen::Vector3d a = at.col(face[0]);
  const Eigen::Vector3d b = at.col(face[1]);
  const Eigen::Vector3d c = at.col(face[2]);
  if ((turn_of(p, a, b, c) > 0.0) == (turn_of(q, a, b, c) > 0.0)) return false;
  const bool first = turn_of(p, q, a, b) > 0.0;
  return first == (turn_of(p, q, b, c) > 0.0) && first == (turn_of(p, q, c, a) > 0.0);
}

inline bool has(const Corners& face, std::uint32_t vertex) {
  return face[0] == vertex || face[1] == vertex || face[2] == vertex;
}

/// Some edge of `one` without a corner in `other` goes through `other`.
inline bool any_edge_cuts(const deform::Points& at, const Corners& one, const Corners& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t from = one[k];
    const std::uint32_t to = one[(k + 1) % 3];
    if (!has(other, from) && !has(other, to) && edge_cuts(at, from, to, other)) return true;
  }
  return false;
}

inline std::size_t count_self_intersections(const deform::Mesh& mesh) {
  struct Boxed {
    Corners corners;
    Eigen::Vector3d low, high;
  };
  std::vector<Boxed> faces;
  deform::for_each_triangle(mesh, [&](const Corners& corners) {
    const Eigen::Matrix3d places = mesh.vertices(Eigen::all, corners);
    faces.push_back({corners, places.rowwise().minCoeff(), places.rowwise().maxCoeff()});
  });
  std::sort(faces.begin(), faces.end(),
            [](const Boxed& a, const Boxed& b) { return a.low.x() < b.low.x(); });
  std::size_t count = 0;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = i + 1; j < faces.size() && faces[j].low.x() <= faces[i].high.x(); ++j) {
      const Boxed& one = faces[i];
      const Boxed& other = faces[j];
      if ((one.low.array() > other.high.array()).any() ||
          (other.low.array() > one.high.array()).any())
        continue;
      const auto shared = std::count_if(one.corners.begin(), one.corners.end(),
                                        [&](std::uint32_t v) { return has(other.corners, v); });
      if (shared >= 2) continue;
      if (any_edge_cuts(mesh.vertices, one.corners, other.corners) ||
          any_edge_cuts(mesh.vertices, other.corners, one.corners))
        ++count;
    }
  return count;
}

} // namespace nendo::test
