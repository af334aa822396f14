#pragma once
// How steep a field of Wendland's C2 functions can be.

#include <Eigen/Core>

namespace nendo::deform {

/// `gram` is the sum of psi_ij a_i a_j^T over all pairs of coefficients. Returns an L with
/// |s(x) - s(y)| <= L |x - y|, by the field's norm in the native space (jacobian.hpp).
double bound_of_gram(const Eigen::Matrix3d& gram, double radius) noexcept;

} // namespace nendo::deform
