#pragma once
// A kernel from compressible to volume-preserving. Wendland's functions multiply an identity
// matrix: volume that is pressed in is lost, as if the model were full of air. The double curl of
// one is a matrix K with divergence-free columns (Narcowich and Ward 1994; Fuselier 2008), so that
// clay that is pressed in bulges nearby. With u = (x - c) / r and t = |u| < 1, for Wendland's C4
// function:
//   K(u) = (1 - t)^4 ((1 + 4 t - 20 t^2) I + 15 u u^T),   K(0) = I, and 0 for t >= 1.
// The kernel is (1 - keep) psi(t) I + keep K(u). Both terms are positive definite, so their sum is
// positive definite for 0 <= keep <= 1, and its divergence is 1 - keep times that of psi(t) I.

#include <nendo/deform/wendland.hpp>

namespace nendo::deform {

/// The matrix `identity` I + `offset` u u^T.
struct VolumeKernel {
  double identity = 0.0;
  double offset = 0.0;
};

/// Returns the kernel at t >= 0, for 0 <= keep <= 1. `air` is the function psi.
constexpr VolumeKernel volume_kernel(Wendland air, double keep, double t) noexcept {
  if (!(t < 1.0)) return {};
  const double o = 1.0 - t;
  const double o4 = (o * o) * (o * o);
  return {(1.0 - keep) * wendland(air, t) + keep * o4 * (1.0 + t * (4.0 - 20.0 * t)),
          keep * 15.0 * o4};
}

/// The largest slope of K(u) a for |a| = 1: the greatest norm of its derivative, at t = 0.155.
inline constexpr double volume_kernel_steepest = 3.8724;

} // namespace nendo::deform
