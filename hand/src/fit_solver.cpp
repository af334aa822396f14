#include "fit_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dense.hpp"
#include "fit_priors.hpp"

namespace nendo::hand {
namespace {

// An unknown of which the poses leave more than this part of the default's variance is fixed at
// the default.
constexpr double max_left_open = 0.8;

/// The information of such poses about the free unknowns, J^T J. All deviations are in counts here,
/// because the poses' errors say nothing about a gain.
Eigen::MatrixXd information_at(const FitProblem& problem, const FreeUnknowns& free,
                               const Unknowns& at) {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  problem.evaluate(at, residuals, &jacobian);
  problem.hold_weights(residuals, 1.0, jacobian);
  const Eigen::MatrixXd slopes = columns_of(jacobian, free);
  return slopes.transpose() * slopes;
}

/// Levenberg and Marquardt's method over the free unknowns, with deviations in counts by so great a
/// part, which follow from turn to turn. The default pulls with its own weight, 1.
void minimise(const FitProblem& problem, const FreeUnknowns& free, double in_counts, Unknowns& at) {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
  double damping = 1e-3;
  for (int turn = 0; turn < 60; ++turn) {
    problem.evaluate(at, residuals, &jacobian);
    problem.hold_weights(residuals, in_counts, jacobian);
    const double cost = residuals.squaredNorm() + at.squaredNorm();
    const Eigen::MatrixXd slopes = columns_of(jacobian, free);
    Eigen::MatrixXd information = // of which the lower half is used
        Eigen::MatrixXd::Zero(slopes.cols(), slopes.cols());
    information.selfadjointView<Eigen::Lower>().rankUpdate(slopes.transpose());
    Eigen::VectorXd downhill = -(slopes.transpose() * residuals);
    for (std::size_t n = 0; n < free.size(); ++n)
      downhill[static_cast<Eigen::Index>(n)] -= at[free[n]];
    bool better = false;
    double step_length = 0.0;
    for (; !better && damping < 1e12; damping *= 10.0) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() += damping * information.diagonal();
      damped.diagonal().array() += 1.0;
      Eigen::VectorXd step = downhill;
      solve_positive_definite(damped, step);
      Unknowns next = at;
      for (std::size_t n = 0; n < free.size(); ++n)
        next[free[n]] += step[static_cast<Eigen::Index>(n)];
      problem.evaluate(next, residuals, nullptr);
      problem.weigh_as(at, next, in_counts, residuals);
      // false for NaN
      better = residuals.squaredNorm() + next.squaredNorm() <= cost;
      if (!better) continue;
      at = next;
      step_length = step.norm();
      damping *= 0.01; // and once more times 10 by the loop
    }
    damping = std::max(damping, 1e-12);
    if (!better || step_length < 1e-7) break;
  }
}

/// Deviations in counts follow gains that are far off, where poses contradict each other, and lead
/// astray: they begin with a fit in radians, and stay there if they fit much worse than that does.
void minimise_safely(const FitProblem& problem, const FreeUnknowns& free, Unknowns& at) {
  constexpr double much_worse = 2.0;
  Eigen::VectorXd residuals;
  const auto cost_at = [&](const Unknowns& x) {
    problem.evaluate(x, residuals, nullptr);
    return residuals.squaredNorm() + x.squaredNorm();
  };
  minimise(problem, free, 0.0, at);
  Unknowns in_counts = at;
  minimise(problem, free, scatter_in_counts, in_counts);
  if (cost_at(in_counts) <= much_worse * cost_at(at) + 1e-9) at = in_counts;
}

/// The covariance of the free unknowns, with the default as prior.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& information) {
  Eigen::MatrixXd with_default = information;
  with_default.diagonal().array() += 1.0;
  return inverse_of_positive_definite(with_default);
}

/// Removes the unknown that is determined least, if any is not determined; those about which the
/// poses say nothing are removed together.
bool drop_undetermined(FreeUnknowns& free, const Eigen::MatrixXd& information, Unknowns& at) {
  const Eigen::VectorXd open = covariance_of(information).diagonal().head(lines_in(free));
  Eigen::Index worst = 0;
  if (open.size() == 0 || open.maxCoeff(&worst) <= max_left_open) return false;
  FreeUnknowns kept;
  for (std::size_t n = 0; n < free.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    if (row < open.size() && (row == worst || open[row] > 0.999))
      at[free[n]] = 0.0;
    else
      kept.push_back(free[n]);
  }
  free = std::move(kept);
  return true;
}

} // namespace

Eigen::Index lines_in(const FreeUnknowns& free) {
  return std::count_if(free.begin(), free.end(),
                       [](Eigen::Index unknown) { return unknown < line_unknowns; });
}

Solution solve(const FitProblem& problem, FreeUnknowns free, const Unknowns& start) {
  Solution solution;
  solution.at = start;
  solution.free = std::move(free);
  do {
    minimise_safely(problem, solution.free, solution.at);
    solution.information = information_at(problem, solution.free, solution.at);
  } while (drop_undetermined(solution.free, solution.information, solution.at));
  const Eigen::Index lines = lines_in(solution.free);
  solution.covariance = covariance_of(solution.information).topLeftCorner(lines, lines);
  return solution;
}

void refine(const FitProblem& problem, const FreeUnknowns& free, Unknowns& at) {
  minimise(problem, free, scatter_in_counts, at);
}

} // namespace nendo::hand
