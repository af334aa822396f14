#pragma once
// A box whose six sides have a colour each, so that vertices at its edges have two or three.

#include <algorithm>

#include <Eigen/Geometry>

#include <nendo/deform/mesh.hpp>

namespace nendo::test {

/// The normal of a face, of any length.
inline Eigen::Vector3d area_of_face(const deform::Mesh& mesh, std::size_t face) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  const std::uint32_t begin = mesh.face_starts[face], end = mesh.face_starts[face + 1];
  for (std::uint32_t at = begin; at < end; ++at) {
    const Eigen::Vector3d a = mesh.vertices.col(mesh.face_corners[at]);
    const Eigen::Vector3d b = mesh.vertices.col(mesh.face_corners[at + 1 < end ? at + 1 : begin]);
    area += a.cross(b);
  }
  return area;
}

/// The side that looks this way, by the largest part of the normal: 0 to 5.
inline std::uint32_t side_of(const Eigen::Vector3d& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint32_t>(2 * axis + (normal[axis] > 0.0 ? 1 : 0));
}

inline Eigen::Vector4f colour_of_side(std::uint32_t side) {
  Eigen::Vector4f colour(0.125F, 0.125F, 0.125F, 1.0F);
  colour[side / 2] = side % 2 == 1 ? 0.875F : 0.5F;
  return colour;
}

inline deform::Mesh with_six_colours(deform::Mesh mesh) {
  mesh.texcoords = Eigen::Matrix2Xd::Zero(2, 6);
  mesh.look.texcoord_colours.resize(4, 6);
  for (std::uint32_t side = 0; side < 6; ++side)
    mesh.look.texcoord_colours.col(side) = colour_of_side(side);
  mesh.corner_texcoords.resize(mesh.face_corners.size());
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at)
      mesh.corner_texcoords[at] = side_of(area_of_face(mesh, face));
  return mesh;
}

/// The same colours, of vertices: each face has vertices of its own.
inline deform::Mesh soup_of_six_colours(const deform::Mesh& mesh) {
  deform::Mesh loose = mesh;
  const auto corners = static_cast<Eigen::Index>(mesh.face_corners.size());
  loose.vertices.resize(3, corners);
  loose.look.vertex_colours.resize(4, corners);
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at) {
      loose.vertices.col(at) = mesh.vertices.col(mesh.face_corners[at]);
      loose.look.vertex_colours.col(at) = colour_of_side(side_of(area_of_face(mesh, face)));
      loose.face_corners[at] = at;
    }
  return loose;
}

/// The largest difference between a corner's colour and that of its side; 1 if there are none.
/// `counts(face)` says which faces are looked at.
template <class Counts>
float worst_of_six_colours(const deform::Mesh& mesh, const Counts& counts) {
  float worst = mesh.look.texcoord_colours.cols() == mesh.texcoords.cols() ? 0.0F : 1.0F;
  for (std::size_t face = 0; face < mesh.face_count() && worst < 1.0F; ++face)
    for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at)
      if (counts(face))
        worst = std::max(worst, (mesh.look.texcoord_colours.col(mesh.corner_texcoords[at]) -
                                 colour_of_side(side_of(area_of_face(mesh, face))))
                                    .cwiseAbs()
                                    .maxCoeff());
  return mesh.face_count() > 0 ? worst : 1.0F;
}

inline float worst_of_six_colours(const deform::Mesh& mesh) {
  return worst_of_six_colours(mesh, [](std::size_t) { return true; });
}

} // namespace nendo::test
