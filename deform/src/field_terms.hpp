#pragma once
// The terms of a field's sum, written once for all functions that add them up.

#include <cmath>

#include <nendo/deform/field.hpp>

namespace nendo::deform {

inline Eigen::Vector3d polynomial_at(const CsrbfField& field, const Eigen::Vector3d& x) noexcept {
  return field.polynomial.col(0) + field.polynomial.rightCols<3>() * x;
}

/// Adds the field's i-th function at x to `sum`.
inline void add_term(const CsrbfField& field, Eigen::Index i, const Eigen::Vector3d& x,
                     Eigen::Vector3d& sum) noexcept {
  const double radius = field.radii[i];
  const double squared = (x - field.centres.col(i)).squaredNorm();
  if (!(squared < radius * radius)) return;
  sum += wendland(field.kernel, std::sqrt(squared) / radius) * field.coefficients.col(i);
}

} // namespace nendo::deform
