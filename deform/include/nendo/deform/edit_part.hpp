#pragma once
// Copies and removes parts of a model, and merges several models into one.

#include <cstdint>
#include <span>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns the mesh with an appended copy of one of its parts (ModelParts), including its
/// appearance. The copy is shifted along x by 1.05 times the part's width. Other parts keep their
/// indices and bits. Allocates. Error, to be appended to the model's name: bad_input (no such part,
/// or the mesh would be too large).
NENDO_API Result<Mesh> copied_part(const Mesh& mesh, std::uint32_t part);

/// Returns the mesh without one of its parts. Other parts keep their order and bits. Allocates.
/// Error: bad_input (no such part, or it is the only one).
NENDO_API Result<Mesh> removed_part(const Mesh& mesh, std::uint32_t part);

/// Merges the meshes into one, in their order. The first keeps its position, indices and bits. Each
/// further one is placed to the right of the previous one, at a distance of a tenth of the max
/// width, and aligned with the first at the bottom and the front. Equal entries of two models, such
/// as materials, are merged; a different material of the same name is renamed. If some have colours
/// or texture coordinates, the others get white, and (0, 0). Allocates. Error, without a name:
/// bad_input (the result is too large).
NENDO_API Result<Mesh> side_by_side(std::span<const Mesh> models);

} // namespace nendo::deform
