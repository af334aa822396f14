#pragma once
// The displacement field of the paper (Sato, Savchenko, Ohbuchi 2004, section 2.3):
//   s(x) = sum_i a_i psi(|x - c_i| / r_i) + p(x),   p(x) = b0 + b1 x + b2 y + b3 z.

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/wendland.hpp>

namespace nendo::deform {

/// All that is needed to deform a copy of the model elsewhere: a few hundred bytes.
struct CsrbfField {
  Wendland kernel = Wendland::c2;
  Points centres;
  Eigen::VectorXd radii; ///< one a centre
  Points coefficients;   ///< a_i, 3 by #centres
  Eigen::Matrix<double, 3, 4> polynomial =
      Eigen::Matrix<double, 3, 4>::Zero(); ///< p(x) = P (1, x, y, z)

  Eigen::Vector3d displacement_at(const Eigen::Vector3d& x) const noexcept;
};

/// out = points + s(points), column by column; `out` is resized only if its size differs. May be
/// `points` itself. Fields of 256 functions and more are evaluated by a grid over them, which
/// allocates and changes no bit.
void displace(const CsrbfField& field, const Points& points, Points& out);

} // namespace nendo::deform
