#pragma once
// Decompositions of dense matrices. Each is compiled once, here, because Eigen's templates of them
// take seconds to compile.

#include <Eigen/Core>

#include <nendo/base/api.hpp>

namespace nendo::hand {

/// Solves `matrix` x = `right` for a symmetric positive definite matrix, of which the lower half is
/// used. `right` becomes x, and `matrix` its Cholesky factor. No allocation.
NENDO_API void solve_positive_definite(Eigen::Ref<Eigen::MatrixXd> matrix,
                                       Eigen::Ref<Eigen::VectorXd> right);

/// Returns the inverse of a symmetric positive definite matrix, of which the lower half is used.
/// Allocates.
NENDO_API Eigen::MatrixXd inverse_of_positive_definite(const Eigen::MatrixXd& matrix);

/// Returns the eigenvalues of a symmetric matrix, which is not empty, in ascending order.
NENDO_API Eigen::VectorXd eigenvalues_of_symmetric(const Eigen::MatrixXd& matrix);

/// Returns the rotation R with the greatest trace(R^T matrix): the nearest one to a sum of
/// rotations and, for a sum of products a b^T, the one that brings the vectors b closest to a
/// (Wahba's problem). No allocation.
NENDO_API Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

} // namespace nendo::hand
