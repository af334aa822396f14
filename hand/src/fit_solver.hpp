#pragma once
// Solves the least-squares problem of a calibration.

#include <vector>

#include <Eigen/Core>

#include "fit_problem.hpp"

namespace nendo::hand {

/// Indices of unknowns that are not fixed; those of the calibration come first.
using FreeUnknowns = std::vector<Eigen::Index>;

struct Solution {
  Unknowns at = Unknowns::Zero();
  FreeUnknowns free;
  Eigen::MatrixXd information;
  Eigen::MatrixXd covariance; ///< the free unknowns of the calibration only
};

/// Returns how many of these are the calibration's.
Eigen::Index lines_in(const FreeUnknowns& free);

/// Returns the columns of a matrix that belong to these unknowns.
template <class Matrix>
Eigen::MatrixXd columns_of(const Matrix& matrix, const FreeUnknowns& free) {
  Eigen::MatrixXd chosen(matrix.rows(), static_cast<Eigen::Index>(free.size()));
  for (std::size_t at = 0; at < free.size(); ++at)
    chosen.col(static_cast<Eigen::Index>(at)) = matrix.col(free[at]);
  return chosen;
}

/// Finds the likeliest unknowns, and fixes at the default those of the calibration that the poses
/// do not determine. The search begins at `start`.
Solution solve(const FitProblem& problem, FreeUnknowns free, const Unknowns& start);
/// Finds the likeliest values of exactly these unknowns. The others stay.
void refine(const FitProblem& problem, const FreeUnknowns& free, Unknowns& at);

} // namespace nendo::hand
