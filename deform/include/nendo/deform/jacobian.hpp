#pragma once
// Measures how much a field stretches, folds or rotates space: bounds on the derivative of x -> x +
// s(x), and its determinants. Functions do not allocate, lock or make system calls, unless stated.

#include <nendo/base/api.hpp>
#include <nendo/deform/field.hpp>

namespace nendo::deform {

/// Returns an L with |s(x) - s(y)| <= L |x - y| for all x and y. It is proportional to the field's
/// coefficients. If L < 1, x -> x + s(x) is a homeomorphism of space: nothing folds, and distinct
/// points stay distinct. L is the smaller of two bounds, each in O(n^2) time for n centres:
///   the max over all x of the sum of |a_i| max |psi'| / r_i over the supports that contain x;
///   the field's norm in the kernel's native space, which accounts for coefficients that cancel
///   (not for fields that keep the volume).
/// Returns infinity if the field is not finite.
NENDO_API double lipschitz_bound(const CsrbfField& field) noexcept;

/// Tracks points through a sequence of fields, with the Jacobian determinant of the composed map at
/// each point. A determinant that is not positive is a fold.
class NENDO_API DeterminantProbe {
public:
  /// Allocates for this number of points.
  void reserve(Eigen::Index points);
  /// Starts at these points (3 by n) with determinants of 1. Does not allocate for up to the
  /// reserved number of points.
  void start(const Points& points);
  /// Starts at each of these points (3 by n, with n radii) and at six positions around it: those
  /// along the axes where a single function of this kernel is steepest. reserve() must have been
  /// called for ring_size * n points.
  void start_round(const Points& starts, const Eigen::VectorXd& radii, Wendland kernel) noexcept;
  /// Applies a field to the points. The field must have keep_volume 0.
  void advance(const CsrbfField& field) noexcept;

  /// Returns the min determinant of all points since the start; 1 if there are no points.
  double min_determinant() const noexcept { return min_; }

  static constexpr Eigen::Index ring_size = 7;

private:
  void begin(Eigen::Index count) noexcept;
  void fill_last_vector(Eigen::Index count) noexcept;

  Eigen::Matrix<double, Eigen::Dynamic, 4> places_; ///< x, y, z, determinant
  Eigen::Index used_ = 0;                           ///< number of points, in whole vectors
  double min_ = 1.0;
};

} // namespace nendo::deform
