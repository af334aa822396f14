#pragma once
// A mesh's faces as triangles. A face with more than three corners becomes a fan about its first
// corner; a face with fewer gives no triangle.

#include <array>
#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Calls visit(std::array<std::uint32_t, 3>) with the vertices of every triangle.
template <class Visit>
void for_each_triangle(const Mesh& mesh, Visit visit) {
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_starts[face];
    for (std::uint32_t at = begin + 2; at < mesh.face_starts[face + 1]; ++at)
      visit(std::array{mesh.face_corners[begin], mesh.face_corners[at - 1], mesh.face_corners[at]});
  }
}

/// Returns the vertex indices of all triangles, three for each.
inline std::vector<std::uint32_t> corners_of_triangles(const Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& triangle) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  });
  return corners;
}

} // namespace nendo::deform
