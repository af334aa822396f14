#pragma once
// What a VolumeKeeper computes of the vertices of a block and the rings of neighbours around them.

#include <array>
#include <cstdint>
#include <span>

#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// Vectors, the last number of each being 0: one load takes one, where three would wait for three
/// cache lines. A byte is the number of one.
using RingTable = std::array<std::array<float, 4>, 256>;
/// One neighbour of each vertex of a block, by its number in a table.
using RingRow = std::array<std::uint8_t, block_size>;
struct RingPart {
  std::span<const RingRow> rows;
  const RingTable* points;
  const RingTable* directions; ///< or null
};
/// The neighbours of a block's vertices, which are ordered as one meets them going round. The first
/// row has the first neighbour of each vertex, the next one the second, and so on. A vertex that
/// has fewer than the others repeats its last one.
struct BlockRings {
  std::span<const RingPart> parts;
  const float* counts; ///< the number of each vertex' neighbours
};

/// Of each vertex of a block. Where the weight is w, a shape that swells by `far` moves the vertex
/// by w (far direction + min(0.3, fairness per_edge) fairing).
struct alignas(64) RingBlock {
  VertexBlock direction;                  ///< a unit vector, smoothed
  VertexBlock fairing;                    ///< the way to the middle of the ring, sideways
  std::array<float, block_size> per_edge; ///< an inverse edge
  std::array<float, block_size> rate;     ///< growth of the volume with the distance
  std::array<float, block_size> bend;     ///< and with its square
};

/// How the faces at a block's vertices lie.
struct RingFacts {
  double volume = 0.0;         ///< the block's part
  std::array<float, 3> axis{}; ///< the middle of the directions, of length 1
  float min_cosine = 1.0F;     ///< the least of the angles between the axis and a direction
  float sine = 0.0F;           ///< the sine of that angle
  float longest_edge = 0.0F;
  float min_height = 0.0F; ///< at most the least height of a face
  bool is_even = true;     ///< each face looks into the directions of its corners, to 72 degrees
  bool may_turn = false;   ///< some face may have been turned over by swelling since
};

/// Puts a block's vectors first in a table.
void begin_table(const VertexBlock& block, RingTable& table) noexcept;
/// Measures a block. Without the directions of neighbours, its own stay those that `measured` has.
/// `facts` are those of the last time; `is_turned`: the directions have changed since.
void measure_rings(const VertexBlock& block, const BlockRings& rings, bool is_turned,
                   RingBlock& measured, RingFacts& facts) noexcept;

/// Sets the weights of a block's vertices: 1 in the box, and less and less to 0 at `reach` from it.
/// The box is as BlockBounds has it, but with the signs of BoxGate.
void weigh_around_box(const VertexBlock& block, const BlockBounds& box, float reach,
                      float* weights) noexcept;
/// Multiplies the weights by 0 at the surface of a body, and by more and more to 1 at `near` from
/// it.
void hold_near_body(const float* distances, float near, float* weights) noexcept;

/// By how much the volume grows with the distance and with its square.
struct SwellRates {
  double rate, bend;
  bool is_free; ///< some weight is not 0
};
SwellRates swell_rates(const RingBlock& measured, const float* weights) noexcept;
struct Swelling {
  double grown; ///< growth of the volume by fairing, to first order
  float spread; ///< difference of the ways along the directions in the block
  float aside;  ///< the longest way of fairing
};
/// Moves the vertices of a block.
Swelling swell_block(const RingBlock& measured, const float* weights, float far, float fairness,
                     VertexBlock& block) noexcept;

} // namespace nendo::deform
