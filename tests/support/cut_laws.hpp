#pragma once
// What holds for every cut, by checks that share nothing with the code that cuts but the exact test
// of two triangles.

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/triangles.hpp>

#include "geometry/box_tree.hpp"
#include "geometry/triangle_meeting.hpp"

namespace nendo::test {

/// Vertices that faces use, less edges, plus faces.
inline long euler_number(const deform::Mesh& mesh, std::size_t from_face, std::size_t to_face) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::map<std::uint32_t, int> vertices;
  for (std::size_t face = from_face; face < to_face; ++face)
    for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at) {
      const std::uint32_t next =
          at + 1 < mesh.face_starts[face + 1] ? at + 1 : mesh.face_starts[face];
      edges[std::minmax(mesh.face_corners[at], mesh.face_corners[next])] = 1;
      vertices[mesh.face_corners[at]] = 1;
    }
  return static_cast<long>(vertices.size()) - static_cast<long>(edges.size()) +
         static_cast<long>(to_face - from_face);
}
inline long euler_number(const deform::Mesh& mesh) {
  return euler_number(mesh, 0, mesh.face_count());
}

/// How many triangles of a mesh meet others where they should not. Exact.
inline std::size_t count_meetings(const deform::Mesh& mesh) {
  std::vector<deform::SpacePoint> points;
  for (Eigen::Index at = 0; at < mesh.vertices.cols(); ++at)
    points.push_back({mesh.vertices(0, at), mesh.vertices(1, at), mesh.vertices(2, at)});
  std::vector<deform::Corners> triangles;
  deform::for_each_triangle(
      mesh, [&](const std::array<std::uint32_t, 3>& triangle) { triangles.push_back(triangle); });
  const deform::BoxTree tree(points, triangles);
  std::size_t count = 0;
  for (std::uint32_t at = 0; at < triangles.size(); ++at) {
    const deform::SpaceBox box = deform::box_around(points, triangles[at]);
    if (tree.any([&](const deform::SpaceBox& other) { return deform::meet(box, other); },
                 [&](std::uint32_t other) {
                   return other != at &&
                          deform::triangles_meet(points, triangles[at], triangles[other]);
                 }))
      ++count;
  }
  return count;
}

/// What is wrong with a cut; all is 0 if nothing is.
struct CutFaults {
  std::size_t open_parts = 0; ///< not closed, or not two-manifold
  std::size_t meetings = 0;   ///< triangles that meet where they should not
  std::size_t moved = 0;      ///< old vertices that have other bits
  std::size_t infinite = 0;   ///< coordinates that are not finite
  double volume = 0.0;        ///< relative error of the sum
  long euler = 0;             ///< the sum, less what it must be
};

inline CutFaults faults_of(const deform::Mesh& before, const deform::CutModel& cut) {
  CutFaults faults;
  double volume = 0.0;
  long euler = 0;
  for (const deform::Mesh& part : deform::separate(cut)) {
    if (!deform::check_closed_manifold(part)) ++faults.open_parts;
    faults.meetings += count_meetings(part);
    volume += deform::volume_of(part);
    euler += euler_number(part);
  }
  for (Eigen::Index at = 0; at < before.vertices.cols(); ++at)
    if (before.vertices.col(at) != cut.mesh.vertices.col(at)) ++faults.moved;
  for (const double value : cut.mesh.vertices.reshaped())
    if (!std::isfinite(value)) ++faults.infinite;
  const double whole = deform::volume_of(before);
  faults.volume = std::abs(volume - whole) / std::abs(whole);
  // Cutting along circles does not change the sum; then each cut face is added, on both sides.
  const std::size_t half = (cut.mesh.face_count() - cut.first_cut_face) / 2;
  faults.euler = euler - euler_number(before) -
                 2 * euler_number(cut.mesh, cut.first_cut_face, cut.first_cut_face + half);
  return faults;
}

} // namespace nendo::test
