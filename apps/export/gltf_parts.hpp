#pragma once
// Divides a mesh as glTF has it: a primitive for each material, with vertices of its own. glTF has
// one texture coordinate for each vertex, so vertices are split where several meet. Readers copy
// all vertices that a primitive names, so primitives do not share vertices.

#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::exporting {

/// The faces of one material. The three lists of vertices have the same length.
struct GltfPart {
  std::uint32_t material = deform::no_index; ///< an index of the look's materials, or no_index
  std::vector<std::uint32_t> vertices;       ///< vertex indices of the mesh
  std::vector<std::uint32_t> texcoords;      ///< of each vertex, or no_index
  std::vector<std::uint32_t> triangles;      ///< three indices into `vertices` for each triangle
};

/// Returns the parts in the order of their materials; faces without a material come last. The
/// vertices of a part are in the order of the mesh, and then the copies. A vertex without a face
/// belongs to the first part. There is at least one part; it has no triangles if the mesh has none.
std::vector<GltfPart> parts_of(const deform::Mesh& mesh);

} // namespace nendo::exporting
