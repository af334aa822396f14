#pragma once
// A finer mesh of the same surface, for strokes that need more vertices than the model has.

#include <cstdint>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// A subdivided mesh. Its first vertices are those of the original mesh, with their indices and
/// bits.
struct Subdivision {
  Mesh mesh;
  /// The k-th new vertex is the mean of the vertices parents[parent_starts[k]] to
  /// parents[parent_starts[k + 1] - 1] of the original mesh.
  std::vector<std::uint32_t> parent_starts{0};
  std::vector<std::uint32_t> parents;
};

/// Subdivides without smoothing, as Blender's Subdivide does: each edge gets a vertex in its
/// middle, a triangle becomes four, and a face of n > 3 corners becomes n faces around its centre.
/// A concave face that would fold is triangulated first (triangles.hpp). Texture coordinates and
/// vertex colours are interpolated, and faces keep materials and names. Faces of fewer than three
/// corners are unchanged. Allocates.
NENDO_API Subdivision subdivide(const Mesh& mesh);

/// Transfers a shape of the original mesh to the subdivided mesh: old vertices keep their bits, and
/// a new one gets the mean displacement of its parents. `before` and `after` are the layouts of
/// both meshes. Allocates.
NENDO_API BlockShape subdivided(const BlockShape& shape, const BlockLayout& before,
                                const Subdivision& subdivision, const BlockLayout& after);

} // namespace nendo::deform
