#include "solver/dense_assembly.hpp"

#include <algorithm>
#include <cmath>

#include "solver/shared_kernel.hpp"

namespace nendo::deform {

namespace {

/// lower += Psi W Psi^T.
void add_own(const OwnFunctions& own, Eigen::MatrixXd& lower) {
  for (std::size_t e = 0; e < own.size(); ++e) {
    const auto values = own.values(e);
    for (std::size_t j = 0; j < values.size(); ++j) {
      const double factor = own.weight(e) * values[j].psi;
      for (std::size_t i = j; i < values.size(); ++i)
        lower(values[i].point, values[j].point) += factor * values[i].psi;
    }
  }
}

} // namespace

bool assemble_dense(const CsrbfOptions& options, const Points& starts, const Supports& supports,
                    const OwnFunctions& own, Eigen::MatrixXd& lower, Eigen::VectorXd& diagonal) {
  const Eigen::Index n = starts.cols();
  const SharedKernel kernel(options.kernel, supports);
  const Ties ties(options, supports);
  const bool has_own = own.size() > 0;
  const double squared_reach = squared_or_more(std::max(kernel.reach(), ties.reach()));
  if (has_own) {
    lower.setZero();
    add_own(own, lower);
  }
  // The own functions' part of the diagonal is wanted as it is until all ties are found.
  diagonal.setConstant((1.0 + options.smoothing) * kernel.at(0.0));
  bool merged = false;
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j + 1; i < n; ++i) {
      double value = has_own ? lower(i, j) : 0.0;
      const double squared = (starts.col(i) - starts.col(j)).squaredNorm();
      if (squared > squared_reach) { // of local supports most
        lower(i, j) = value;
        continue;
      }
      const double distance = std::sqrt(squared);
      if (distance < ties.reach() || distance == 0.0) {
        const double size = has_own ? (lower(i, i) + lower(j, j)) / 2.0 : 0.0;
        const double tie = ties.strength(distance, size, size - value);
        diagonal[i] += tie;
        diagonal[j] += tie;
        value -= tie;
        merged = true;
      }
      lower(i, j) = value + kernel.at(distance);
    }
  if (has_own)
    lower.diagonal() += diagonal;
  else
    lower.diagonal() = diagonal;
  return merged;
}

} // namespace nendo::deform
