#pragma once
// Copies and removes parts of a model.

#include <cstdint>

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

} // namespace nendo::deform
