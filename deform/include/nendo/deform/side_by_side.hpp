#pragma once
// Merges several models into one.

#include <span>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Merges the meshes into one, in their order. The first keeps its position, indices and bits. Each
/// further one is placed to the right of the previous one, at a distance of a tenth of the max
/// width, and aligned with the first at the bottom and the front. Equal entries of two models, such
/// as materials, are merged; a different material of the same name is renamed. If some have colours
/// or texture coordinates, the others get white, and (0, 0). Allocates. Error, without a name:
/// bad_input (the result is too large).
NENDO_API Result<Mesh> side_by_side(std::span<const Mesh> models);

} // namespace nendo::deform
