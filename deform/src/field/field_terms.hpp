#pragma once
// The terms of a field's sum, written once for all functions that add them up.

#include <cmath>

#include <nendo/deform/field.hpp>
#include <nendo/deform/volume_kernel.hpp>

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
  const double t = std::sqrt(squared) / radius;
  if (field.keep_volume <= 0.0) {
    sum += wendland(field.kernel, t) * field.coefficients.col(i);
    return;
  }
  const Eigen::Vector3d u = (x - field.centres.col(i)) / radius;
  const VolumeKernel kernel = volume_kernel(field.kernel, field.keep_volume, t);
  sum += kernel.identity * field.coefficients.col(i) +
         kernel.offset * u.dot(field.coefficients.col(i)) * u;
}

} // namespace nendo::deform
