#pragma once
// More decompositions, for this library alone; see dense.hpp.

#include <nendo/deform/dense.hpp>

namespace nendo::deform {

EigenPairs<3> eigen3(const Eigen::Matrix3d& symmetric) noexcept;
EigenPairs<4> eigen4(const Eigen::Matrix4d& symmetric) noexcept;
/// Returns the largest eigenvalue of a symmetric matrix, by the closed formula.
double largest_eigenvalue(const Eigen::Matrix3d& symmetric) noexcept;
/// Returns the inverse, by LU with partial pivoting. Allocates.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix);

} // namespace nendo::deform
