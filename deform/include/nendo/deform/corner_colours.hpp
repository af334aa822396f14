#pragma once
// Colours of vertices as colours of corners, and back: files differ in which of the two they have.

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Replaces look.vertex_colours by texcoord_colours, so that vertices of different colours can
/// become one. Does nothing if the mesh has no colours of vertices. Allocates.
NENDO_API void move_colours_to_corners(Mesh& mesh);

/// Returns the colours of vertices, 4 by #vertices, for files that have no others: those of the
/// mesh, or for each vertex the mean of its corners' colours. White where there is no corner. Empty
/// if the mesh has no colours. Allocates.
NENDO_API Eigen::Matrix4Xf mean_vertex_colours(const Mesh& mesh);

/// Returns how many vertices have corners of different colours.
NENDO_API std::size_t count_colour_seams(const Mesh& mesh);

/// Returns whether the texture coordinates are more than places for colours.
NENDO_API bool has_texture_places(const Mesh& mesh) noexcept;

} // namespace nendo::deform
