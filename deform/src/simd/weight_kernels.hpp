#pragma once
// Cardinal weights: with frozen start points, a vertex moves by sum_j W_j(x) g_j, linear in the
// displacements g_j. W = Phi A^-1 is computed in double and then rounded, so that the large
// coefficients of crowded fingertips have cancelled before. The time to apply weights depends on
// how many bytes are read. So where a start point's weights differ little within a block, as nearly
// everywhere, they are kept as steps of 16 bits from the middle of their range.

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/field_kernels.hpp"

namespace nendo::deform {

/// The size of a step. A weight in steps is the middle plus a multiple of this, and is off by half
/// of it at most.
inline constexpr float weight_step = 0x1p-19F;
/// With more start points than this, each vertex would have so many weights that evaluating the
/// field is cheaper.
inline constexpr std::size_t max_weighted_starts = 64;
/// The largest distance from the middle that 16 bits can hold.
inline constexpr float max_from_middle = 32767 * weight_step;

/// The weights of start point `start` at the 64 vertices of a block.
struct WeightEntry {
  std::uint32_t start;
  float middle; ///< 0 where a weight is 0, which moves nothing at all; of float weights always
};

/// The entries of a block, from entries[first] on: `in_steps` of them are in steps, and the next
/// `in_float` in float. Their weights are in the same order, from weights[first_byte] on.
struct WeightedBlock {
  std::uint32_t block;
  std::uint16_t in_steps, in_float;
  std::size_t first, first_byte;
};

inline constexpr std::size_t bytes_in_steps = block_size * sizeof(std::int16_t);
inline constexpr std::size_t bytes_in_float = block_size * sizeof(float);

struct WeightCache {
  WeightedBlock* blocks; ///< at least as many as the shape has
  WeightEntry* entries;  ///< `max_entries`
  std::byte* weights;    ///< `max_bytes`, aligned for vectors
  std::size_t max_entries, max_bytes;
  std::size_t block_count;
  std::size_t used_entries, used_bytes;
  double largest; ///< absolute weight
};

struct WeightSource {
  /// Entry e's coefficient is sum_j map[e * starts + j] g_j, for each coordinate. The map contains
  /// the kernel's constant factor.
  const double* map;
  /// The same for p(x), 4 numbers per start point; or null.
  const double* polynomial;
  std::size_t starts;
  /// Where no weight of a start point in a block is larger than this, its weights are left out
  /// there.
  float least;
  double* kernel_scratch; ///< 64 for each entry, of which there must be precise ones
  float* weight_scratch;  ///< 64 for each start point
};

/// Fills the cache. Returns false if it is too small, or if a weight is not finite.
bool build_weights(const FieldView& field, const BlockPass& pass, const WeightSource& source,
                   WeightCache& cache) noexcept;

/// Applies the cache to the blocks [begin, end) of a shape; `to` may be `from`.
struct WeightPass {
  const std::array<float, 4>* by;      ///< start points' displacements: x, y, z, 0
  const std::array<float, 4>* by_step; ///< those, times weight_step
  const VertexBlock* from;
  VertexBlock* to;
  std::size_t begin, end;
  bool large; ///< as BlockPass has it
};

/// Computes to = from + sum_j W_j g_j.
void apply_weights(const WeightCache& cache, const WeightPass& pass) noexcept;

} // namespace nendo::deform
