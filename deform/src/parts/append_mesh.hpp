#pragma once
// Puts meshes into one.

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Puts `more` after all of `mesh`. Its faces' materials and names are those of the lists of
/// `mesh`, and it has texture coordinates and colours if `mesh` has. Allocates.
void append_mesh(const Mesh& more, Mesh& mesh);

/// Returns whether all the numbers of both together can be counted.
bool fit_together(const Mesh& a, const Mesh& b) noexcept;

} // namespace nendo::deform
