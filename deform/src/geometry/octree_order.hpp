#pragma once
// The paper's first step (Sato, Savchenko, Ohbuchi 2004, section 2.4): it orders points as an
// octree's leaves are visited, so that points near in space are near in the list, and the matrix of
// their interactions is banded.

#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns a permutation: the k-th point in order is points.col(order[k]). The octree's root is the
/// points' bounding cube, and its depth is 21 (Morton codes of 63 bits). Points that are not finite
/// come last. They and the points of one leaf keep the order of their indices. Allocates.
std::vector<std::uint32_t> octree_order(const Points& points);

} // namespace nendo::deform
