#pragma once
// The vector code's view of a field, and its entry points, which choose the machine's best
// instruction set at run time. All numbers are in a layout's coordinates (BlockLayout).

#include <array>
#include <cstddef>
#include <cstdint>

#include <nendo/deform/field.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/deform/wendland.hpp>

namespace nendo::deform {

/// The numbers of a centre that the evaluation needs. Kernels are functions of o = max(1 - t, 0).
/// c0 and c2 use r o instead, which saves a product; their coefficients are divided by the same
/// power of r. The coefficients also contain the kernel's constant factor (kernel_factor). Fields
/// that keep the volume use o, and the coefficients as they are.
template <class Real>
struct FieldEntry {
  Real x, y, z;
  Real radius;
  Real inverse_radius;
  Real inner; ///< 1.25 r; of fields that keep the volume 15 keep / r^2
  std::array<Real, 3> coefficient{};
};

/// Returns the factor that the vector code leaves out: psi = factor * o^p * (polynomial in o) with
/// o = 1 - t.
constexpr double kernel_factor(Wendland kernel) noexcept {
  if (kernel == Wendland::c2) return 4.0;
  return kernel == Wendland::c4 ? 1.0 / 3.0 : 1.0;
}

/// Returns the factor in psi' / t = factor * o^p * (polynomial in o); for c0 the right side is
/// divided by t.
constexpr double slope_factor(Wendland kernel) noexcept {
  switch (kernel) {
  case Wendland::c0:
    return -2.0;
  case Wendland::c2:
    return -20.0;
  case Wendland::c4:
    return -56.0 / 3.0;
  case Wendland::c6:
    return -22.0;
  }
  return 0.0;
}

/// Returns the power of r o in psi. It is 0 for c4 and c6, which use o.
constexpr int weight_power(Wendland kernel) noexcept {
  if (kernel == Wendland::c0) return 2;
  return kernel == Wendland::c2 ? 5 : 0;
}

/// Centres as separate arrays of coordinates, to find those that reach a block. Arrays are padded
/// to whole vectors with a negative radius.
struct CentreArrays {
  const float* x;
  const float* y;
  const float* z;
  const float* squared_radius;
  const std::uint32_t* names; ///< numbers of their entries
  std::size_t count;
};

/// Arrays for centres that reach several blocks.
struct CandidateArrays {
  std::uint32_t* names;
  float* x;
  float* y;
  float* z;
  float* squared_radius;
};

/// The number of blocks whose lists are made together.
inline constexpr std::size_t group_size = 16;

/// Memory for one thread's lists of centres while a pass runs. Candidates' arrays have
/// padded_list_size(count) entries, and lists have group_size times as many.
struct ListScratch {
  std::uint32_t* lists;
  std::array<CandidateArrays, 2> candidates;
};
constexpr std::size_t padded_list_size(std::size_t entries) noexcept {
  return (entries + 2 * block_size - 1) / block_size * block_size;
}

struct FieldView {
  Wendland kernel;
  double keep_volume; ///< 0 to 1; above 0, the kernel is that of volume_kernel.hpp
  CentreArrays centres;
  const FieldEntry<float>* entries;
  const FieldEntry<double>* precise_entries; ///< used instead if not null: sums in double
  /// P of p(x) = P (1, x, y, z), or null.
  const std::array<std::array<double, 4>, 3>* polynomial;
};

/// Blocks [begin, end) of a shape; `to` may be `from`. A block that nothing reaches is neither read
/// nor written, and reached[block] = 0; otherwise it is 1.
struct BlockPass {
  const VertexBlock* from;
  VertexBlock* to = nullptr;
  /// What the field's displacements at `from` are added to; null: `from`. Only for fields that keep
  /// the volume.
  const VertexBlock* base = nullptr;
  const BlockBounds* bounds; ///< those of `from`
  /// Those of `to`, where blocks were written; may be `bounds`, may be null.
  BlockBounds* new_bounds = nullptr;
  std::uint8_t* reached;
  std::size_t begin, end;
  ListScratch scratch;
  /// Set if the shape does not stay in the caches. Blocks are then fetched before their turn and,
  /// if `to` is another shape, written past the caches. Other threads may read them after
  /// hwy::FlushStream().
  bool large = false;
};

void displace_pass(const FieldView& field, const BlockPass& pass) noexcept;
/// Returns the number of pairs of a block and a centre that reaches it. Uses only the bounds and
/// the scratch memory.
std::size_t count_pairs(const FieldView& field, const BlockPass& pass) noexcept;

/// The lengths of arrays are multiples of this.
inline constexpr std::size_t probe_vector = 8;

/// Places that move through a field, as separate arrays of coordinates, which need not be aligned.
struct ProbeArrays {
  double* x;
  double* y;
  double* z;
  double* determinant;
  std::size_t count; ///< a multiple of probe_vector
};

/// Computes determinant *= det(I + ds/dx), and then x += s(x). Returns the
/// least determinant.
double advance_probes(const CsrbfField& field, const ProbeArrays& probes) noexcept;

} // namespace nendo::deform
