#pragma once
// The area vectors of the faces around each vertex, from which normals are computed.

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns for each vertex the sum of twice the area vectors of its faces, 3 by #vertices, in
/// squares of `unit`, a length in model units. `places` are the vertices, 3 by #vertices, and
/// `mesh` has the faces. With a unit near the model's size, squares are finite for any model.
/// Allocates.
NENDO_API Points vertex_areas(const Mesh& mesh, const Points& places, double unit);

} // namespace nendo::deform
