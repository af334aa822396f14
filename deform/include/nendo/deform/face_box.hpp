#pragma once
// The size of a model is that of its faces: files have stray vertices far from them, of lines that
// were left out for example.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns the axis-aligned bounding box of the finite vertices that faces have; of all finite
/// vertices, if there is no face.
NENDO_API Box box_of_faces(const Mesh& mesh) noexcept;

/// Returns the vertices that no face has; none, if there is no face: that is a cloud of points.
NENDO_API std::vector<std::uint32_t> stray_vertices(const Mesh& mesh);

/// Returns the faces with the vertices that they have, without look and texture coordinates;
/// nothing if there is no stray vertex.
NENDO_API std::optional<Mesh> without_stray_vertices(const Mesh& mesh);

} // namespace nendo::deform
