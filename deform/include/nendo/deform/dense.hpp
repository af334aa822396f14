#pragma once
// Eigen's decompositions of small and of dense matrices. Each is compiled once, in dense.cpp: in
// every other source its templates would take seconds.

#include <Eigen/Core>

#include <nendo/base/api.hpp>

namespace nendo::deform {

/// The eigenvalues of a symmetric matrix, rising, and its eigenvectors as columns.
template <int size>
struct EigenPairs {
  Eigen::Vector<double, size> values;
  Eigen::Matrix<double, size, size> vectors;
};
NENDO_API EigenPairs<3> eigen3(const Eigen::Matrix3d& symmetric) noexcept;
NENDO_API EigenPairs<4> eigen4(const Eigen::Matrix4d& symmetric) noexcept;
/// As eigen3(), by the closed formula: faster, and less precise where eigenvalues are close.
NENDO_API EigenPairs<3> eigen3_direct(const Eigen::Matrix3d& symmetric) noexcept;

/// Returns the largest eigenvalue of a symmetric matrix, by the closed formula.
NENDO_API double largest_eigenvalue(const Eigen::Matrix3d& symmetric) noexcept;

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
/// Solves matrix x = right for a positive definite matrix, by L D L^T.
NENDO_API Vector6d solve_spd6(const Matrix6d& matrix, const Vector6d& right) noexcept;

/// Returns the inverse, by LU with partial pivoting. Allocates.
NENDO_API Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix);

} // namespace nendo::deform
