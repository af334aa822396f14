#pragma once
// Several models as one.

#include <span>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Merges the meshes into one, in their order. The first stays where it is, with its numbers and
/// bits. Each further one is placed to the right of the previous one, a tenth of the widest one's
/// width from it, as low as the first, and as far in front. What is the same in two models, as a
/// material, is one entry; another material of the same name gets a new name. If some have colours
/// or texture coordinates, the others get white, and (0, 0). Allocates. Error, without a name:
/// bad_input (too large together).
NENDO_API Result<Mesh> side_by_side(std::span<const Mesh> models);

} // namespace nendo::deform
