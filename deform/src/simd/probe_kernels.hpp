#pragma once
// Places that are followed through a field, with the determinants of its Jacobian: in vectors of
// double, for each tick of an injective deformer asks for them.

#include <cstddef>

#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// Arrays are whole multiples of this.
inline constexpr std::size_t probe_vector = 8;

/// Coordinates apart; the arrays need not be aligned.
struct ProbeArrays {
  double* x;
  double* y;
  double* z;
  double* determinant;
  std::size_t count; ///< a multiple of probe_vector
};

/// determinant *= det(I + ds/dx), then x += s(x). Returns the least determinant. As jacobian_at().
double advance_probes(const CsrbfField& field, const ProbeArrays& probes) noexcept;

} // namespace nendo::deform
