#pragma once
// Eigen's decompositions of small matrices. Each is compiled once, in decompositions.cpp: in every
// other source its templates would take seconds.

#include <Eigen/Core>

#include <nendo/base/api.hpp>

namespace nendo::deform {

/// The eigenvalues of a symmetric matrix, rising, and its eigenvectors as columns.
template <int size>
struct EigenPairs {
  Eigen::Vector<double, size> values;
  Eigen::Matrix<double, size, size> vectors;
};
/// By the closed formula: faster than iterations, and less precise where eigenvalues are close.
NENDO_API EigenPairs<3> eigen3_direct(const Eigen::Matrix3d& symmetric) noexcept;

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
/// Solves matrix x = right for a positive definite matrix, by L D L^T.
NENDO_API Vector6d solve_spd6(const Matrix6d& matrix, const Vector6d& right) noexcept;

} // namespace nendo::deform
