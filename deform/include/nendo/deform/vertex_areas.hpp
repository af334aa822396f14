#pragma once
// The areas of the faces around each vertex, of which normals are made.

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns for each vertex the sum of twice the area vectors of its faces, 3 by #vertices, in
/// squares of `unit`, a length in model units. `places` are the vertices, 3 by #vertices, and the
/// mesh says which faces there are. A unit near the model's size keeps squares of any model finite.
/// Allocates.
NENDO_API Points vertex_areas(const Mesh& mesh, const Points& places, double unit);

} // namespace nendo::deform
