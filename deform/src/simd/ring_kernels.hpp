#pragma once
// What a VolumeKeeper computes of the vertices of a block and the rings of neighbours around them.

#include <array>
#include <cstddef>
#include <span>

#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// A block's vertices and their neighbours, which are ordered as one meets them going round. A
/// block of them has the first neighbour of each vertex, the next one the second, and so on. A
/// vertex that has fewer than the others repeats its last one.
struct BlockRings {
  std::span<const VertexBlock> points, normals; ///< of the neighbours; normals or nothing
  const float* counts;                          ///< of each vertex' neighbours
};

/// Of each vertex of a block. Where the weight is w, a shape that swells by f moves the vertex by
/// w (f direction + min(0.3, 2 |f| per_edge) fairing).
struct alignas(64) RingBlock {
  VertexBlock direction;                  ///< of length 1, smoothed
  VertexBlock fairing;                    ///< the way to the middle of the ring, sideways
  std::array<float, block_size> per_edge; ///< an inverse edge
  std::array<float, block_size> rate;     ///< by which the volume grows with the distance
  std::array<float, block_size> bend;     ///< and with its square
};

/// Measures a block, and sets `normals`, which are the volume's derivatives by its vertices.
/// Without the normals of neighbours, the directions are those that `measured` has. Returns the
/// block's part of the volume.
double measure_rings(const VertexBlock& block, const BlockRings& rings, VertexBlock& normals,
                     RingBlock& measured) noexcept;

/// By how much the volume grows with the distance and with its square.
struct SwellRates {
  double rate, bend;
  bool is_free; ///< some weight is not 0
};
SwellRates swell_rates(const RingBlock& measured, const float* weights) noexcept;
/// Moves the vertices of a block.
void swell_block(const RingBlock& measured, const float* weights, float far,
                 VertexBlock& block) noexcept;

} // namespace nendo::deform
