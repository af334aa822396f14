#include "solver/reserve_solver.hpp"

#include <algorithm>

namespace nendo::deform {

CsrbfField zero_field(const Supports& supports, Eigen::Index points, Wendland kernel) {
  const Eigen::Index functions = supports.functions(points);
  return {.kernel = kernel,
          .centres = Points::Zero(3, functions),
          .radii = Eigen::VectorXd::Ones(functions),
          .coefficients = Points::Zero(3, functions)};
}

void reserve_solver(CsrbfSolver& solver, const Supports& supports, Eigen::Index points) {
  if (points > CsrbfSolver::lean_size) return;
  Points apart(3, points); // anything that can be solved will do
  for (Eigen::Index i = 0; i < points; ++i)
    apart.col(i).setConstant(static_cast<double>(i) * supports.shared.front().radius);
  CsrbfField field = zero_field(supports, points, Wendland::c2);
  solver.build(apart, supports);
  solver.solve(Points::Zero(3, points), field);
}

Supports rounded(Supports supports, const BlockLayout& layout) {
  for (Support& support : supports.shared)
    support.radius = layout.rounded_radius(support.radius);
  for (OwnSupport& own : supports.own)
    own.support.radius = layout.rounded_radius(own.support.radius);
  return supports;
}

Eigen::VectorXd min_radii(const Supports& supports, Eigen::Index points) {
  double shared = supports.shared.front().radius;
  for (const Support& support : supports.shared)
    shared = std::min(shared, support.radius);
  Eigen::VectorXd radii = Eigen::VectorXd::Constant(points, shared);
  for (const OwnSupport& own : supports.own)
    radii[own.point] = std::min(radii[own.point], own.support.radius);
  return radii;
}

} // namespace nendo::deform
