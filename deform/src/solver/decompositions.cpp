#include "solver/decompositions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace nendo::deform {

EigenPairs<3> eigen3(const Eigen::Matrix3d& symmetric) noexcept {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

EigenPairs<4> eigen4(const Eigen::Matrix4d& symmetric) noexcept {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

EigenPairs<3> eigen3_direct(const Eigen::Matrix3d& symmetric) noexcept {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

double largest_eigenvalue(const Eigen::Matrix3d& symmetric) noexcept {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(symmetric, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[2];
}

Vector6d solve_spd6(const Matrix6d& matrix, const Vector6d& right) noexcept {
  return matrix.ldlt().solve(right);
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix) {
  return Eigen::PartialPivLU<Eigen::MatrixXd>(matrix).inverse();
}

} // namespace nendo::deform
