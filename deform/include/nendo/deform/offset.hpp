#pragma once
// Models far from the origin: surveyed terrain, a part in its assembly, a scan in world
// coordinates. Rounding errors of floats grow with the distance from the origin. So the vertices of
// such a model are stored relative to a position near it (Mesh::offset).

#include <string>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns the offset that suits a mesh, in file coordinates. On an axis on which the centre of its
/// faces is at most four times its size from 0, the offset is 0, so that most models keep their
/// file's coordinates. On other axes it is the centre, to a millionth of the size: subtracting it
/// from a vertex of a face is then exact, and so is adding it (Sterbenz 1974).
NENDO_API Eigen::Vector3d usual_offset(const Mesh& mesh) noexcept;

/// Sets the mesh's offset, and adapts its vertices so that file coordinates do not change.
NENDO_API void count_from(const Eigen::Vector3d& offset, Mesh& mesh) noexcept;

/// Returns a position of a mesh with this offset as text in file coordinates: "(0, 1, 2.5)".
NENDO_API std::string place_text(const Eigen::Vector3d& place, const Eigen::Vector3d& offset);
/// The same of a vertex.
inline std::string place_text(const Mesh& mesh, std::uint32_t vertex) {
  return place_text(mesh.vertices.col(vertex), mesh.offset);
}

} // namespace nendo::deform
