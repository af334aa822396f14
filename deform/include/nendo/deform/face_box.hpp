#pragma once
// Measures a model by its faces only, because files may have stray vertices far from them, for
// example vertices of ignored lines.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns the axis-aligned bounding box of the finite vertices of faces, or of all finite vertices
/// if there is no face.
NENDO_API Box box_of_faces(const Mesh& mesh) noexcept;

/// Returns the vertices without a face. Empty if there is no face, because the mesh is then a point
/// cloud.
NENDO_API std::vector<std::uint32_t> stray_vertices(const Mesh& mesh);

/// Returns the faces and their vertices, without appearance and texture coordinates; nullopt if
/// there is no stray vertex.
NENDO_API std::optional<Mesh> without_stray_vertices(const Mesh& mesh);

} // namespace nendo::deform
