#pragma once
// Vertices that a file had to split become one again: where it has no way to say that faces share a
// vertex (STL), or splits them where normals, texture coordinates or colours meet (glTF).

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct Welding {
  std::size_t joined = 0;   ///< vertices that became one with another one
  std::size_t coloured = 0; ///< vertices that stay apart from one in their place, for their colour
};

/// Makes vertices of exactly one place one, wherever faces meet there edge to edge. The first
/// vertex of a place stays, so the order does. Where surfaces only touch, in a point, or at an edge
/// with four faces, they stay apart: the model is not less of a manifold than it was. Texture
/// coordinates of corners stay. Vertices of different colours stay apart, too. `group_of_vertex`,
/// if not empty, names for each vertex those among which it may be joined. Coordinates must be
/// finite. Allocates.
Welding weld_places(Mesh& mesh, std::span<const std::uint32_t> group_of_vertex = {});

/// Adds a note if vertices stay apart for their colours.
void note_welding(const Welding& welding, std::vector<std::string>& notes);

/// Returns whether no two faces share a vertex, though there are several faces.
bool is_soup(const Mesh& mesh);

/// What renumber_corners() dropped.
struct DroppedCorners {
  std::size_t faces = 0;   ///< that had fewer than three vertices
  std::size_t corners = 0; ///< of other faces, that repeated the one before
};

/// Gives corners the vertices that `vertex_of` names, and drops what has become too thin by it.
/// Vertices that only dropped faces had stay.
DroppedCorners renumber_corners(Mesh& mesh, std::span<const std::uint32_t> vertex_of);

/// Keeps the faces for which `keeps` is not 0, with all that belongs to them.
void keep_faces(Mesh& mesh, std::span<const std::uint8_t> keeps);

/// Keeps the vertices for which `keeps` is not 0. No face may have another one.
void keep_vertices(Mesh& mesh, std::span<const std::uint8_t> keeps);

} // namespace nendo::deform
