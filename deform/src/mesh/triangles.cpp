#include <nendo/deform/triangles.hpp>

#include <algorithm>
#include <utility>

#include "mesh/columns.hpp"

namespace nendo::deform {

std::vector<std::uint32_t> corners_of_triangles(const Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  corners.reserve(mesh.face_corners.size());
  for_each_triangle(mesh, [&](const Triangle& triangle) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  });
  return corners;
}

Mesh with_split_faces(const Mesh& mesh, const Points& places, const std::vector<bool>& is_split) {
  Mesh split = mesh;
  split.face_starts.assign(1, 0);
  split.face_corners.clear();
  split.corner_texcoords.clear();
  for (auto* column : face_columns(split.look))
    column->clear();
  FaceTriangles triangles(mesh, places);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    if (!is_split[face]) {
      for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at)
        append_corner(mesh, at, split);
      end_face(mesh, face, split);
      continue;
    }
    for (const Triangle& triangle : triangles.of(face)) {
      for (const std::uint32_t corner : triangle)
        append_corner(mesh, corner, split);
      end_face(mesh, face, split);
    }
  }
  return split;
}

Mesh with_triangles_of(Mesh mesh, const Points& rest) {
  FaceTriangles now(mesh);
  FaceTriangles before(mesh, rest);
  std::vector<bool> differs(mesh.face_count(), false);
  bool any = false;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto corners = mesh.corners_of(face);
    const auto is_new = [&](std::uint32_t vertex) { return vertex >= rest.cols(); };
    if (corners.size() < 4 || std::ranges::any_of(corners, is_new)) continue;
    differs[face] = !std::ranges::equal(now.of(face), before.of(face));
    any = any || differs[face];
  }
  return any ? with_split_faces(mesh, rest, differs) : std::move(mesh);
}

Mesh in_shape(const Mesh& model, Points places) {
  Mesh moved = model;
  moved.vertices = std::move(places);
  return with_triangles_of(std::move(moved), model.vertices);
}

} // namespace nendo::deform
