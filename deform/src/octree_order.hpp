#pragma once
// The paper's first step (Sato, Savchenko, Ohbuchi 2004, section 2.3): points in the order in which
// an octree's leaves are visited, so that what is near in space is near in the list, and the matrix
// of their interactions is banded.

#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// A permutation: the k-th point in order is points.col(order[k]). The octree's root is the points'
/// bounding cube, its depth 21 (Morton codes of 63 bits); points of one leaf, and points that are
/// not finite (which come last), keep the order of their indices. Allocates.
std::vector<std::uint32_t> octree_order(const Points& points);

} // namespace nendo::deform
