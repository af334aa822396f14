#include "clay/field_bound.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace nendo::deform {

double bound_of_gram(const Eigen::Matrix3d& gram, double radius) noexcept {
  constexpr double derivative_norm_squared = 20.0;                   // of Wendland's C2
  const Eigen::Matrix3d symmetric = 0.5 * (gram + gram.transpose()); // but for rounding it is
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(symmetric, Eigen::EigenvaluesOnly);
  const double largest = std::max(0.0, solver.eigenvalues()[2]);
  return std::sqrt(derivative_norm_squared * largest) / radius;
}

} // namespace nendo::deform
