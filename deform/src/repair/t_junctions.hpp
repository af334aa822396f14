#pragma once
// Vertices that lie on an edge of another face, as a CAD program's triangles leave them.

#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Puts vertices of open edges into open edges on which they lie, within the tolerance, as more
/// corners of the face there. `place_of` has one entry for each corner, and gets those of new ones.
/// Returns how many corners were put in; 0 also if there are too many open edges to be looked at.
/// Allocates.
std::size_t split_at_junctions(Mesh& mesh, std::vector<std::uint32_t>& place_of, double tolerance);

} // namespace nendo::deform
