#pragma once
// Cardinal weights: with frozen start points, a vertex moves by sum_j W_j(x) g_j, linear in the
// displacements g_j. W = Phi A^-1 is computed in double and stored in float: coefficients of
// thousands that cancel (crowded fingertips) are gone before anything is rounded.

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/field_kernels.hpp"

namespace nendo::deform {

/// 64 weights for each of `count` start points: starts[first + k] are their numbers,
/// weights[64 (first + k)] on their weights.
struct WeightedBlock {
  std::uint32_t block;
  std::uint32_t count;
  std::size_t first;
};

struct WeightCache {
  WeightedBlock* blocks; ///< room for all of the shape's
  float* weights;        ///< 64 times `room`
  std::uint16_t* starts; ///< `room`
  std::size_t room;
  std::size_t block_count;
  std::size_t used;
  double largest; ///< absolute weight
};

struct WeightSource {
  /// Entry e's coefficient is sum_j map[e * starts + j] g_j, for each coordinate by itself; the
  /// kernel's constant factor is contained.
  const double* map;
  /// The same for p(x): 4 numbers a start point, or null.
  const double* polynomial;
  std::size_t starts;
  /// Weights that are nowhere in a block larger than this are left out there.
  float least;
  double* room_for_kernels; ///< 64 for each entry, of which there must be precise ones
};

/// Fills the cache; false if its room is not enough, or a weight is not finite.
bool build_weights(const FieldView& field, const BlockPass& pass, const WeightSource& source,
                   WeightCache& cache) noexcept;

/// to = from + sum_j W_j displacements[j], for the cache's blocks [begin, end). `to` may be `from`.
void apply_weights(const WeightCache& cache, std::size_t begin, std::size_t end,
                   const std::array<float, 4>* displacements, const VertexBlock* from,
                   VertexBlock* to) noexcept;

/// Of written blocks, for who changes a shape in place.
void update_bounds(const VertexBlock& block, BlockBounds& bounds) noexcept;

} // namespace nendo::deform
