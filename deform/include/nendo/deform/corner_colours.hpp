#pragma once
// Converts vertex colours to corner colours and back, because a file format has either of them.

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Replaces look.vertex_colours by texcoord_colours, so that vertices of different colours can be
/// merged. Does nothing if the mesh has no vertex colours. Allocates.
NENDO_API void move_colours_to_corners(Mesh& mesh);

/// Returns vertex colours, 4 by #vertices, for file formats without corner colours: the mesh's
/// vertex colours, or the mean of each vertex's corner colours. Vertices without a corner are
/// white. Empty if the mesh has no colours. Allocates.
NENDO_API Eigen::Matrix4Xf mean_vertex_colours(const Mesh& mesh);

/// Returns the number of vertices whose corners differ in colour.
NENDO_API std::size_t count_colour_seams(const Mesh& mesh);

/// Returns whether the mesh has texture coordinates that serve more than to index corner colours.
NENDO_API bool has_texture_places(const Mesh& mesh) noexcept;

} // namespace nendo::deform
