#pragma once
// Meshes of files as surfaces of triangles, and back.

#include <cstdint>
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

/// What is the same in two models is one entry. Another material of the same name gets a new name.
class LookCollector {
public:
  /// `look` must outlive this.
  explicit LookCollector(Appearance& look) : look_(look) {}

  /// Starts with another mesh's lists; the numbers of its entries are then known.
  void take(const Appearance& from);
  /// Returns the entries of a face of that mesh.
  FaceLook look_of(const Appearance& from, std::size_t face) const;

private:
  std::uint32_t number_of(const Texture& texture);
  std::uint32_t number_of(Material material);
  static std::vector<std::uint32_t> numbers_of(const FaceNames& from, FaceNames& to);

  Appearance& look_;
  std::vector<std::uint32_t> textures_, materials_, groups_, objects_;
};

} // namespace nendo::deform
