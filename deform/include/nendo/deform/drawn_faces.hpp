#pragma once
// Selects the faces that pictures show, in drawing order.

#include <cstdint>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns whether faces of that material are drawn: it is at most half transparent.
NENDO_API bool is_drawn(const Material& material) noexcept;

/// Returns the faces that are drawn: first those without a material, then those of each material,
/// so that entry m + 1 has those of material m, each in the mesh's order. If no face is of a
/// material that is drawn, all faces are. Allocates.
NENDO_API std::vector<std::vector<std::uint32_t>> drawn_faces(const Mesh& mesh);

} // namespace nendo::deform
