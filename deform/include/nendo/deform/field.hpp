#pragma once
// The displacement field of the paper (Sato, Savchenko, Ohbuchi 2004, section 2.4):
//   s(x) = sum_i a_i psi(|x - c_i| / r_i) + p(x),   p(x) = b0 + b1 x + b2 y + b3 z.
// With keep_volume, the matrices of volume_kernel.hpp replace psi.

#include <span>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/wendland.hpp>

namespace nendo::deform {

/// A field s(x). With its few hundred bytes, other code can deform a copy of the model.
struct NENDO_API CsrbfField {
  Wendland kernel = Wendland::c2;
  Points centres;        ///< c_i, 3 by #centres, in model units
  Eigen::VectorXd radii; ///< r_i, one per centre, in model units
  Points coefficients;   ///< a_i, 3 by #centres
  Eigen::Matrix<double, 3, 4> polynomial =
      Eigen::Matrix<double, 3, 4>::Zero(); ///< p(x) = P (1, x, y, z)
  double keep_volume = 0.0;                ///< 0: compressible, to 1: volume-preserving
  /// True for the first half of a midpoint step. It is not applied by itself: the next field is
  /// evaluated at x + s(x), and displaces x.
  bool is_halfway = false;

  /// Returns s(x).
  Eigen::Vector3d displacement_at(const Eigen::Vector3d& x) const noexcept;
};

/// Computes out = points + s(points) for 3 by #points. `out` may be `points` itself, and is resized
/// only if its size differs. Fields of 256 functions and more are evaluated with a grid, which
/// allocates memory; the result is the same bit for bit.
NENDO_API void displace(const CsrbfField& field, const Points& points, Points& out);
/// Applies fields in order, including halfway ones. `out` may be `points` itself.
NENDO_API void displace(std::span<const CsrbfField> fields, const Points& points, Points& out);

} // namespace nendo::deform
