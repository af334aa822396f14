#pragma once
// Selects the faces that pictures show, in drawing order.

#include <cstdint>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns whether faces with this material are drawn: the material is at most half transparent.
NENDO_API bool is_drawn(const Material& material) noexcept;

/// Returns the drawn faces by material: entry 0 has the faces without a material, and entry m + 1
/// the faces with material m, in the mesh's order. If no face has a drawn material, all faces are
/// drawn. Allocates.
NENDO_API std::vector<std::vector<std::uint32_t>> drawn_faces(const Mesh& mesh);

} // namespace nendo::deform
