#include <nendo/hand/dense.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace nendo::hand {

void solve_positive_definite(Eigen::Ref<Eigen::MatrixXd> matrix,
                             Eigen::Ref<Eigen::VectorXd> right) { // NOLINT: a Ref is a reference
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(matrix).solveInPlace(right);
}

Eigen::MatrixXd inverse_of_positive_definite(const Eigen::MatrixXd& matrix) {
  return matrix.llt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

// As SelfAdjointEigenSolver::compute() does, but without its code for eigenvectors.
Eigen::VectorXd eigenvalues_of_symmetric(const Eigen::MatrixXd& matrix) {
  if (matrix.cols() == 1) return matrix.diagonal();
  Eigen::MatrixXd scaled = matrix.triangularView<Eigen::Lower>();
  double scale = scaled.cwiseAbs().maxCoeff();
  if (scale == 0.0) scale = 1.0;
  scaled.triangularView<Eigen::Lower>() /= scale;
  const Eigen::Tridiagonalization<Eigen::MatrixXd> tridiagonal(scaled);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(tridiagonal.diagonal(), tridiagonal.subDiagonal(),
                                Eigen::EigenvaluesOnly);
  return solver.eigenvalues() * scale;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

} // namespace nendo::hand
