#pragma once
// The derivative of a field, summed in double: the reference for bounds and probes.

#include <cmath>

#include <nendo/deform/field.hpp>
#include <nendo/deform/volume_kernel.hpp>

namespace nendo::test {

/// Returns the derivatives of both numbers after t, divided by t, for t > 0.
constexpr deform::VolumeKernel volume_kernel_slope(deform::Wendland air, double keep,
                                                   double t) noexcept {
  if (!(t < 1.0)) return {};
  const double o = 1.0 - t;
  const double o3 = o * o * o;
  return {(1.0 - keep) * wendland_slope(air, t) / t - keep * 60.0 * o3 * (1.0 - 2.0 * t),
          -keep * 60.0 * o3 / t};
}

/// u: from the centre, in radii; not 0.
inline void add_volume_term(const deform::CsrbfField& field, Eigen::Index i,
                            const Eigen::Vector3d& u, Eigen::Matrix3d& jacobian) noexcept {
  const Eigen::Vector3d a = field.coefficients.col(i) / field.radii[i];
  const deform::VolumeKernel kernel =
      deform::volume_kernel(field.kernel, field.keep_volume, u.norm());
  const deform::VolumeKernel slope = volume_kernel_slope(field.kernel, field.keep_volume, u.norm());
  const double along = u.dot(a);
  jacobian += (slope.identity * a + slope.offset * along * u) * u.transpose() +
              kernel.offset * u * a.transpose();
  jacobian.diagonal().array() += kernel.offset * along;
}

/// Returns I + ds/dx at x. At a centre of Wendland::c0, where s has no derivative, that centre's
/// term is left out.
inline Eigen::Matrix3d jacobian_at(const deform::CsrbfField& field,
                                   const Eigen::Vector3d& x) noexcept {
  Eigen::Matrix3d jacobian = field.polynomial.rightCols<3>();
  jacobian.diagonal().array() += 1.0;
  for (Eigen::Index i = 0; i < field.centres.cols(); ++i) {
    const Eigen::Vector3d offset = x - field.centres.col(i);
    const double radius = field.radii[i];
    const double squared = offset.squaredNorm();
    if (!(squared < radius * radius) || squared == 0.0) continue;
    const double distance = std::sqrt(squared);
    if (field.keep_volume > 0.0) {
      add_volume_term(field, i, offset / radius, jacobian);
      continue;
    }
    const double slope = wendland_slope(field.kernel, distance / radius) / (radius * distance);
    jacobian.noalias() += field.coefficients.col(i) * (slope * offset).transpose();
  }
  return jacobian;
}

} // namespace nendo::test
