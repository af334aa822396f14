#include "solver/polynomial_part.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/usable.hpp"
#include "solver/decompositions.hpp"

namespace nendo::deform {

void PolynomialPart::assemble(const Points& starts, Polynomial polynomial) {
  const Eigen::Index n = starts.cols();
  basis_.resize(n, 4);
  const Eigen::Vector3d middle =
      n > 0 ? Eigen::Vector3d(starts.rowwise().mean()) : Eigen::Vector3d::Zero();
  double spread = 1.0 / largest_number;
  for (Eigen::Index i = 0; i < n; ++i)
    spread = std::max(spread, (starts.col(i) - middle).norm());
  for (Eigen::Index i = 0; i < n; ++i)
    basis_.row(i) << 1.0, (starts.col(i) - middle).transpose() / spread;
  if (polynomial == Polynomial::none) basis_.setZero();
  if (polynomial == Polynomial::constant && n > 0) basis_.rightCols<3>().setZero();
  Eigen::Matrix4d normalise = Eigen::Matrix4d::Zero(); // (1, x) -> (1, (x - middle) / spread)
  normalise(0, 0) = 1.0;
  normalise.block<3, 1>(1, 0) = -middle / spread;
  normalise.block<3, 3>(1, 1).diagonal().setConstant(1.0 / spread);
  orthonormalise(normalise);
}

void PolynomialPart::orthonormalise(const Eigen::Matrix4d& normalise) {
  // Eigenvalues are squares: this keeps directions in which the points spread more than 1e-6 of
  // their size.
  constexpr double min_eigenvalue = 1e-12;
  Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
  for (Eigen::Index i = 0; i < basis_.rows(); ++i)
    gram.noalias() += basis_.row(i).transpose() * basis_.row(i);
  const EigenPairs<4> eigen = eigen4(gram);
  const double least = min_eigenvalue * static_cast<double>(basis_.rows());
  Eigen::Matrix4d change = eigen.vectors;
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double value = eigen.values[k];
    const bool determined = value > least;
    change.col(k) *= determined ? 1.0 / std::sqrt(value) : 0.0;
    undetermined_[k] = determined ? 0.0 : 1.0;
  }
  for (Eigen::Index i = 0; i < basis_.rows(); ++i) {
    const Eigen::RowVector4d changed = basis_.row(i) * change;
    basis_.row(i) = changed;
  }
  world_to_basis_.noalias() = change.transpose() * normalise;
}

bool PolynomialPart::eliminate(KernelSystem& system) {
  solved_basis_ = basis_;
  system.solve_in_place(solved_basis_);
  Eigen::Matrix4d schur = undetermined_.asDiagonal();
  schur.noalias() += basis_.transpose() * solved_basis_;
  schur_.compute(schur);
  return schur_.info() == Eigen::Success;
}

/// a = M^-1 (g - Q b) with (Q^T M^-1 Q + U) b = Q^T M^-1 g - sums.
Eigen::Matrix4d PolynomialPart::solve(Rows& a, const Eigen::Matrix4d& sums) const noexcept {
  Eigen::Matrix4d b = -sums;
  b.noalias() += basis_.transpose() * a;
  schur_.solveInPlace(b);
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    a.row(i) -= solved_basis_.row(i) * b;
  return b;
}

void PolynomialPart::subtract(const Eigen::Matrix4d& b, Rows& residual) const noexcept {
  for (Eigen::Index i = 0; i < residual.rows(); ++i)
    residual.row(i) -= basis_.row(i) * b;
}

Eigen::Matrix4d PolynomialPart::missing_sums(const Rows& a,
                                             const Eigen::Matrix4d& b) const noexcept {
  Eigen::Matrix4d sums = -(undetermined_.asDiagonal() * b);
  sums.noalias() -= basis_.transpose() * a;
  return sums;
}

Eigen::Matrix<double, 3, 4> PolynomialPart::in_world(const Eigen::Matrix4d& b) const noexcept {
  return b.leftCols<3>().transpose() * world_to_basis_;
}

} // namespace nendo::deform
