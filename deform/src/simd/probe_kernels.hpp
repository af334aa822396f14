#pragma once
// Moves places through a field and computes the determinants of its Jacobian there, in vectors of
// double, because every tick of an injective deformer needs them.

#include <cstddef>

#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// The lengths of arrays are multiples of this.
inline constexpr std::size_t probe_vector = 8;

/// Places as separate arrays of coordinates, which need not be aligned.
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
