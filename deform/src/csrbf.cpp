#include <algorithm>
#include <cassert>

#include "solver/csrbf_state.hpp"
#include "usable.hpp"

namespace nendo::deform {

void CsrbfSolver::State::solve_in_place(Rows& a, Eigen::Matrix4d& b, const Eigen::Matrix4d& sums) {
  system_->solve_in_place(a);
  if (has_polynomial() && !is_polynomial_apart()) b += polynomial_.solve(a, sums);
}

FieldStatus CsrbfSolver::State::solve(const Points& displacements, CsrbfField& field) {
  assert(displacements.cols() == starts_.cols());
  if (!usable_) return FieldStatus::singular;
  if (!all_usable(displacements)) return FieldStatus::not_finite;
  right_side_.resize(displacements.cols(), 4);
  for (std::size_t k = 0; k < order_.size(); ++k)
    right_side_.row(static_cast<Eigen::Index>(k)) << displacements.col(order_[k]).transpose(), 0.0;
  Eigen::Matrix4d b = Eigen::Matrix4d::Zero();
  Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
  if (is_polynomial_apart()) {
    solution_ = right_side_;
    shared_system_->solve_in_place(solution_);
    b = polynomial_.solve(solution_, sums);
    polynomial_.subtract(b, right_side_);
  }
  solution_ = right_side_;
  solve_in_place(solution_, b, sums);
  correction_ = right_side_;
  system_->subtract_product(solution_, correction_);
  if (has_polynomial() && !is_polynomial_apart()) {
    polynomial_.subtract(b, correction_);
    sums = polynomial_.missing_sums(solution_, b);
  }
  solve_in_place(correction_, b, sums);
  solution_ += correction_;
  if (!write(field, b)) return FieldStatus::not_finite;
  return merged_ ? FieldStatus::merged : FieldStatus::ok;
}

/// The field in the order in which the start points came; not if it is not finite.
bool CsrbfSolver::State::write(CsrbfField& field, const Eigen::Matrix4d& b) {
  // The square leaves room for sums and for the product with any usable coordinate.
  constexpr double largest_coefficient = largest_number * largest_number;
  Eigen::Matrix<double, 3, 4> polynomial = Eigen::Matrix<double, 3, 4>::Zero();
  if (has_polynomial()) polynomial = polynomial_.in_world(b);
  own_coefficients_.resize(static_cast<Eigen::Index>(own_.size()), 4);
  for (std::size_t e = 0; e < own_.size(); ++e)
    own_coefficients_.row(static_cast<Eigen::Index>(e)) = own_.coefficient(e, solution_);
  double heaviest = 1.0;
  for (const Support& support : supports.shared)
    heaviest = std::max(heaviest, support.weight);
  if (!all_usable(solution_, largest_coefficient / heaviest) ||
      !all_usable(own_coefficients_, largest_coefficient) ||
      !all_usable(polynomial, largest_coefficient))
    return false;

  const Eigen::Index n = starts_.cols();
  const Eigen::Index functions = supports.functions(n);
  field.kernel = options_.kernel;
  field.polynomial = polynomial;
  field.centres.resize(3, functions);
  field.radii.resize(functions);
  field.coefficients.resize(3, functions);
  Eigen::Index begin = 0;
  for (const Support& support : supports.shared) {
    field.centres.middleCols(begin, n) = starts_;
    field.radii.segment(begin, n).setConstant(support.radius);
    for (std::size_t k = 0; k < order_.size(); ++k)
      field.coefficients.col(begin + order_[k]) =
          support.weight * solution_.row(static_cast<Eigen::Index>(k)).head<3>().transpose();
    begin += n;
  }
  for (std::size_t e = 0; e < supports.own.size(); ++e) {
    const auto at = static_cast<Eigen::Index>(e);
    field.centres.col(begin + at) = starts_.col(supports.own[e].point);
    field.radii[begin + at] = supports.own[e].support.radius;
    field.coefficients.col(begin + at) = own_coefficients_.row(at).head<3>().transpose();
  }
  return true;
}

CsrbfSolver solver_with(const CsrbfOptions& options, const SolverChoices& choices) {
  CsrbfSolver solver(options);
  solver.state_->choices = choices;
  return solver;
}

CsrbfSolver::CsrbfSolver(CsrbfOptions options) : state_(std::make_unique<State>(options)) {}
CsrbfSolver::~CsrbfSolver() = default;
CsrbfSolver::CsrbfSolver(CsrbfSolver&&) noexcept = default;
CsrbfSolver& CsrbfSolver::operator=(CsrbfSolver&&) noexcept = default;

void CsrbfSolver::reserve(Eigen::Index points) {
  state_->reserve(points);
}

FieldStatus CsrbfSolver::build(const Points& starts, const Supports& supports) {
  assert(!supports.shared.empty());
  if (!all_usable(starts) || !supports.are_usable()) return FieldStatus::not_finite;
  state_->supports = supports;
  return state_->build(starts);
}

FieldStatus CsrbfSolver::build(const Points& starts, const Eigen::VectorXd& radii) {
  assert(starts.cols() == radii.size());
  if (!all_usable(starts) || !all_usable(radii) || !(radii.array() > 0.0).all())
    return FieldStatus::not_finite;
  assign_radii(state_->supports, radii);
  return state_->build(starts);
}

FieldStatus CsrbfSolver::solve(const Points& displacements, CsrbfField& field) {
  return state_->solve(displacements, field);
}

const SolverEffort& CsrbfSolver::effort() const noexcept {
  return state_->effort;
}

} // namespace nendo::deform
