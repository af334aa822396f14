#pragma once
// How much a field stretches, folds or turns space: the derivative of x -> x + s(x), and bounds on
// it. All of it without allocation, lock or system call.

#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// I + ds/dx. At a centre of Wendland::c0, where s has no derivative, that centre's term is left
/// out.
Eigen::Matrix3d jacobian_at(const CsrbfField& field, const Eigen::Vector3d& x) noexcept;

/// L with |s(x) - s(y)| <= L |x - y| for all x and y; never less than the least such number, and
/// proportional to the field's coefficients. Below 1, x -> x + s(x) is a homeomorphism of space:
/// nothing folds, nothing that was apart meets. The lesser of two bounds, both O(n^2):
///   the sum of |a_i| max |psi'| / r_i, of the supports that can reach where c_j is the nearest
///   centre; the field's norm in the kernel's native space, which knows how coefficients cancel.
/// Infinite if the field is not finite.
double lipschitz_bound(const CsrbfField& field) noexcept;

/// Follows points through fields that are applied one after another, and the determinants of the
/// composition's Jacobian there. A fold is where one is not positive.
class DeterminantProbe {
public:
  /// Allocates for this many points.
  void reserve(Eigen::Index points);
  /// Starts at these points, with determinants of 1. No allocation up to the number reserved.
  void start(const Points& points);
  /// As start(), but at each start point (3 by n, n radii) and at the six places along the axes
  /// round it where a lone field of this kernel is steepest. Needs room for `ring_size` n points.
  void start_round(const Points& starts, const Eigen::VectorXd& radii, Wendland kernel) noexcept;
  void advance(const CsrbfField& field) noexcept;

  /// 1 if there are no points.
  double least() const noexcept { return least_; }

  static constexpr Eigen::Index ring_size = 7;

private:
  void begin(Eigen::Index count) noexcept;
  void fill_last_vector(Eigen::Index count) noexcept;

  Eigen::Matrix<double, Eigen::Dynamic, 4> places_; ///< x, y, z, determinant
  Eigen::Index used_ = 0;                           ///< in whole vectors
  double least_ = 1.0;
};

} // namespace nendo::deform
