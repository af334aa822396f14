#pragma once
// Copies and removes parts of a model.

#include <cstdint>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns the mesh with a copy of one of its parts (ModelParts) behind all else, with all that the
/// part looks like. The copy is aside along x, by 1.05 times the part's width. The others keep
/// their numbers and bits. Allocates. Error, which goes behind the model's name: bad_input (there
/// is no such part, or it would be too large).
NENDO_API Result<Mesh> copied_part(const Mesh& mesh, std::uint32_t part);

/// Returns the mesh without one of its parts. The others keep their order and bits. Allocates.
/// Error: bad_input (there is no such part, or no other).
NENDO_API Result<Mesh> removed_part(const Mesh& mesh, std::uint32_t part);

} // namespace nendo::deform
