#pragma once
// Vertices that a file had to split become one again: where it has no way to say that faces share a
// vertex (STL), or splits them where normals, texture coordinates or colours meet (glTF).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Makes vertices of exactly one place one, wherever faces meet there edge to edge. The first
/// vertex of a place stays, so the order does. Where surfaces only touch, in a point, or at an edge
/// with four faces, they stay apart: the model is not less of a manifold than it was. Corners keep
/// their texture coordinates and colours. `group_of_vertex`, if not empty, names for each vertex
/// those among which it may be joined. Coordinates must be finite. Returns how many vertices became
/// one with another one. Allocates.
std::size_t weld_places(Mesh& mesh, std::span<const std::uint32_t> group_of_vertex = {});

/// Returns whether no two faces share a vertex, though there are several faces.
bool is_soup(const Mesh& mesh);

/// What renumber_corners() dropped.
struct DroppedCorners {
  std::size_t faces = 0;   ///< that had fewer than three vertices
  std::size_t corners = 0; ///< corners of other faces, that repeated the previous one
};

/// Gives corners the vertices that `vertex_of` names, and drops what has become too thin by it.
/// Vertices that only dropped faces had stay.
DroppedCorners renumber_corners(Mesh& mesh, std::span<const std::uint32_t> vertex_of);

/// Keeps the corners for which `keeps` is not 0, and the faces that have one of them, with all that
/// belongs to them.
void keep_corners(Mesh& mesh, std::span<const std::uint8_t> keeps);

/// Keeps the faces for which `keeps` is not 0. Each face must have a corner. `of_corner` loses the
/// entries of the other faces, if it has one for each corner.
void keep_faces(Mesh& mesh, std::span<const std::uint8_t> keeps,
                std::vector<std::uint32_t>& of_corner);

} // namespace nendo::deform
