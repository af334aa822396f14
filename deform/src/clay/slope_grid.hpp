#pragma once
// How steep a field of Wendland's C2 functions of one radius can be: two bounds.

#include <Eigen/Core>

#include "field/block_field.hpp"
#include "simd/press_kernels.hpp"

namespace nendo::deform {

/// `gram` is the sum of psi_ij a_i a_j^T over all pairs of coefficients. Returns an L with
/// |s(x) - s(y)| <= L |x - y|, by the field's norm in the native space (jacobian.hpp).
double bound_of_gram(const Eigen::Matrix3d& gram, double radius) noexcept;

/// Bounds the slope cell by cell of space: nowhere is it steeper than the sum of |a_i| |psi'| / r
/// over the functions that reach there. Where many functions push side by side into one direction,
/// that is less than bound_of_gram(), which grows with the surface that they push. Belongs to one
/// thread. After the constructor nothing allocates.
class SlopeGrid {
public:
  SlopeGrid();

  /// Begins with no function. All will be of that radius, with centres in that box.
  void begin(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius) noexcept;
  /// Adds a function with a coefficient of that length.
  void add(const Eigen::Vector3d& centre, double coefficient) noexcept;
  /// Returns an L with |s(x) - s(y)| <= L |x - y|.
  double lipschitz_bound() const noexcept;

private:
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  double radius_ = 1.0;
  SlopeCells cells_{};
  VectorArray<float> sums_; ///< one a cell
};

} // namespace nendo::deform
