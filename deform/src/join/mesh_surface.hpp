#pragma once
// Meshes of files as surfaces of triangles, and back.

#include <span>
#include <utility>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "join/triangle_surface.hpp"

namespace nendo::deform {

/// Several meshes as surfaces with one list of materials, textures and names. What is the same in
/// two meshes is one entry; another material of the same name gets a new name. If some mesh has
/// colours or texture coordinates, all surfaces have some: white, and (0, 0). Colours are those of
/// corners if some mesh has such colours.
struct SharedSurfaces {
  std::vector<TriangleSurface> surfaces;
  Appearance look; ///< its lists of faces and vertices are empty
};

/// Faces become triangles as in triangles.hpp. Allocates.
SharedSurfaces surfaces_of(std::span<const Mesh* const> meshes);

/// Returns the surface of one mesh, with Mesh::detail, and its lists. Allocates.
std::pair<TriangleSurface, Appearance> single_surface_of(const Mesh& mesh);

/// Returns the mesh, with the surface's detail. Materials, textures, names and texture points that
/// no face uses are left out. Allocates.
Mesh mesh_of(const TriangleSurface& surface, const Appearance& look);

} // namespace nendo::deform
