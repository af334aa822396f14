#pragma once
// Decides which vertices share a block, and so how many blocks a support reaches.

#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns a permutation of the points in which each block_size points, from the first on, are a
/// leaf of a k-d tree (Bentley 1975, with leaves of one size). The tree halves points across the
/// longest side of their box until a leaf is left. In an octree's order, a block may span two cells
/// that are far apart; in this order, a support of a sixth of a scanned model meets a sixth to a
/// third fewer blocks. Points within a block are in the order of their indices, and points that are
/// not finite come last. Allocates.
std::vector<std::uint32_t> block_order(const Points& points);

} // namespace nendo::deform
