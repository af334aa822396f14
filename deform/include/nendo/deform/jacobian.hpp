#pragma once
// How much a field stretches, folds or turns space: bounds on the derivative of x -> x + s(x), and
// its determinants. Nothing here allocates, locks or calls the system, except where it says so.

#include <nendo/base/api.hpp>
#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// Returns an L with |s(x) - s(y)| <= L |x - y| for all x and y. It is proportional to the field's
/// coefficients. If L < 1, x -> x + s(x) is a homeomorphism of space: nothing folds, and nothing
/// that was apart meets. L is the lesser of two bounds, each of which takes O(n^2) for n centres:
///   the largest sum of |a_i| max |psi'| / r_i over the supports that reach one place;
///   the field's norm in the kernel's native space, which accounts for coefficients that cancel;
///   not of fields that keep the volume.
/// Returns infinity if the field is not finite.
NENDO_API double lipschitz_bound(const CsrbfField& field) noexcept;

/// Follows points through fields that are applied one after another, and the determinants of the
/// composition's Jacobian there. A fold is where one is not positive.
class NENDO_API DeterminantProbe {
public:
  /// Allocates for this many points.
  void reserve(Eigen::Index points);
  /// Starts at these points (3 by n) with determinants of 1. Does not allocate for up to as many
  /// points as were reserved.
  void start(const Points& points);
  /// Starts at each of these points (3 by n, with n radii) and at six places round it: those along
  /// the axes where a field of this kernel with this centre alone is steepest. reserve() must have
  /// been called for ring_size * n points.
  void start_round(const Points& starts, const Eigen::VectorXd& radii, Wendland kernel) noexcept;
  /// Takes the points through this field, which is not one that keeps the volume.
  void advance(const CsrbfField& field) noexcept;

  /// Returns the least determinant that any point has had since the start; 1 if there are no
  /// points.
  double least() const noexcept { return min_; }

  static constexpr Eigen::Index ring_size = 7;

private:
  void begin(Eigen::Index count) noexcept;
  void fill_last_vector(Eigen::Index count) noexcept;

  Eigen::Matrix<double, Eigen::Dynamic, 4> places_; ///< x, y, z, determinant
  Eigen::Index used_ = 0;                           ///< in whole vectors
  double min_ = 1.0;
};

} // namespace nendo::deform
