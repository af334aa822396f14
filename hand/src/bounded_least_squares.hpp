#pragma once
// Damped least squares with a range for each unknown: K. Levenberg (1944), D. W. Marquardt (1963),
// "An algorithm for least-squares estimation of nonlinear parameters", with an active set for the
// ranges (J. Nocedal, S. J. Wright, "Numerical Optimization", 2006, chapters 10.3 and 16.7). Sizes
// are fixed at compile time: nothing is allocated.

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <nendo/hand/dense.hpp>

namespace nendo::hand {

template <int N>
struct Box {
  Eigen::Matrix<double, N, 1> low;
  Eigen::Matrix<double, N, 1> high;
};

/// The normal equations of half a sum of squares at one place, in the approximation of Gauss and
/// Newton.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> matrix;   ///< J^T J
  Eigen::Matrix<double, N, 1> gradient; ///< J^T r
  double cost = 0.0;                    ///< r^T r / 2
  double farthest_m = 0.0;              ///< the largest distance to a target
};

struct Effort {
  int max_iterations = 20;
  double enough_m = 0.0;      ///< stop as soon as no target is farther
  double min_step_rad = 1e-9; ///< stop when a step is shorter
};

/// Returns the step that lowers the quadratic model most without leaving the box. At first it holds
/// those unknowns that are at an end of their range and are pushed out of it; then it also holds
/// each unknown that would leave the box.
template <int N>
Eigen::Matrix<double, N, 1>
bounded_step(const Eigen::Matrix<double, N, N>& matrix, const Eigen::Matrix<double, N, 1>& gradient,
             const Eigen::Matrix<double, N, 1>& at, const Box<N>& box) noexcept {
  Eigen::Matrix<double, N, 1> held_step = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Array<bool, N, 1> held;
  for (int k = 0; k < N; ++k) {
    held[k] = box.low[k] >= box.high[k] || (at[k] <= box.low[k] && gradient[k] > 0.0) ||
              (at[k] >= box.high[k] && gradient[k] < 0.0);
  }
  Eigen::Matrix<double, N, 1> step = held_step;
  for (int round = 0; round <= N; ++round) {
    Eigen::Matrix<double, N, N> system = matrix;
    Eigen::Matrix<double, N, 1> right = -gradient;
    right.noalias() -= matrix * held_step;
    for (int k = 0; k < N; ++k) {
      if (!held[k]) continue;
      system.row(k).setZero();
      system.col(k).setZero();
      system(k, k) = 1.0;
      right[k] = held_step[k];
    }
    if constexpr (N > 4) {
      step = right;
      solve_positive_definite(system, step);
    } else {
      step = system.llt().solve(right);
    }
    bool inside = true;
    for (int k = 0; k < N; ++k) {
      const double to = at[k] + step[k];
      if (held[k] || (to >= box.low[k] && to <= box.high[k])) continue;
      held[k] = true;
      held_step[k] = (to < box.low[k] ? box.low[k] : box.high[k]) - at[k];
      inside = false;
    }
    if (inside) break;
  }
  return step;
}

/// Goes downhill from `at`, which must lie in the box, and stays in the box. `model(place)` returns
/// the NormalEquations at a place. `at` and `here` become the last place and its equations.
template <int N, class Model>
void minimise(const Model& model, const Box<N>& box, const Effort& effort,
              Eigen::Matrix<double, N, 1>& at, NormalEquations<N>& here) noexcept {
  here = model(at);
  double damping = 1e-3;
  double growth = 2.0;
  for (int k = 0; k < effort.max_iterations && here.farthest_m > effort.enough_m; ++k) {
    Eigen::Matrix<double, N, N> damped = here.matrix;
    damped.diagonal().array() += damping * here.matrix.diagonal().maxCoeff() + 1e-12;
    const auto step = bounded_step<N>(damped, here.gradient, at, box);
    const Eigen::Matrix<double, N, 1> there = (at + step).cwiseMax(box.low).cwiseMin(box.high);
    const NormalEquations<N> next = model(there);
    const double step_rad = (there - at).cwiseAbs().maxCoeff();
    if (next.cost < here.cost) {
      // The more exactly the model predicted the descent, the farther it may be trusted (H. B.
      // Nielsen, "Damping parameter in Marquardt's method", 1999).
      const double predicted = -step.dot(here.gradient) - 0.5 * step.dot(here.matrix * step);
      const double quality = predicted > 0.0 ? (here.cost - next.cost) / predicted : 1.0;
      const double cubed = (2.0 * quality - 1.0) * (2.0 * quality - 1.0) * (2.0 * quality - 1.0);
      damping = std::max(damping * std::max(1.0 / 3.0, 1.0 - cubed), 1e-12);
      growth = 2.0;
      at = there;
      here = next;
    } else {
      damping *= growth;
      growth *= 2.0;
    }
    if (!(step_rad > effort.min_step_rad)) break;
  }
}

} // namespace nendo::hand
