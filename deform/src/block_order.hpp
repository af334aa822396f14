#pragma once
// Which vertices share a block: what decides how many blocks a support reaches.

#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// A permutation of points of which each block_size from the first on are the leaf of a k-d tree:
/// halved across the longest side of what they span until they are that few (Bentley 1975, with
/// leaves of one size). Beside an octree's order, whose blocks may reach across two far cells, a
/// support of a sixth of a scanned model meets a sixth to a third fewer of them. Within a block in
/// the order of their indices; points that are not finite come last. Allocates.
std::vector<std::uint32_t> block_order(const Points& points);

} // namespace nendo::deform
