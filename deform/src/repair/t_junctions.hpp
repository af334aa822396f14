#pragma once
// Vertices that lie on an edge of another face, as a CAD program's triangles leave them.

#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct SplitJunctions {
  std::size_t count = 0;    ///< corners that were put in
  bool is_too_many = false; ///< there are too many open edges to be looked at: nothing was done
};

/// Puts vertices of open edges into open edges on which they lie, within the tolerance, as more
/// corners of the face there. `place_of` has one entry for each corner, and gets those of new ones.
/// Allocates.
SplitJunctions split_at_junctions(Mesh& mesh, std::vector<std::uint32_t>& place_of,
                                  double tolerance);

} // namespace nendo::deform
