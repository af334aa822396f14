#include <algorithm>
#include <cassert>

#include "geometry/usable.hpp"
#include "solver/csrbf_state.hpp"
#include "solver/volume_assembly.hpp"

namespace nendo::deform {

void CsrbfSolver::State::solve_in_place(Rows& a, Eigen::Matrix4d& b, const Eigen::Matrix4d& sums) {
  system_->solve_in_place(a);
  if (has_polynomial() && !is_polynomial_apart()) b += polynomial_.solve(a, sums);
}

void CsrbfSolver::State::take_right_side(const Points& displacements) {
  right_side_.resize(rows_of(displacements.cols()), 4);
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const auto displacement = displacements.col(order_[k]);
    if (!keeps_volume()) {
      right_side_.row(row) << displacement.transpose(), 0.0;
      continue;
    }
    right_side_.middleRows<3>(3 * row).setZero();
    right_side_.block<3, 1>(3 * row, 0) = displacement;
  }
}

FieldStatus CsrbfSolver::State::solve(const Points& displacements, CsrbfField& field) {
  assert(displacements.cols() == starts_.cols());
  if (!usable_) return FieldStatus::singular;
  if (!all_usable(displacements)) return FieldStatus::not_finite;
  take_right_side(displacements);
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

/// Of the start point that has this place in the order of elimination.
Eigen::Vector3d CsrbfSolver::State::coefficient(Eigen::Index place) const {
  if (keeps_volume()) return solution_.block<3, 1>(3 * place, 0);
  return solution_.row(place).head<3>();
}

void CsrbfSolver::State::take_own_coefficients() {
  own_coefficients_.resize(static_cast<Eigen::Index>(supports.own.size()), 4);
  for (std::size_t e = 0; e < supports.own.size(); ++e) {
    auto row = own_coefficients_.row(static_cast<Eigen::Index>(e));
    if (keeps_volume()) {
      const OwnSupport& own = ordered_supports_.own[e];
      row << own_volume_coefficient(options_, ordered_starts_, own, solution_).transpose(), 0.0;
    } else {
      row = own_.coefficient(e, solution_);
    }
  }
}

/// The field in the order in which the start points came; not if it is not finite.
bool CsrbfSolver::State::write(CsrbfField& field, const Eigen::Matrix4d& b) {
  // The square leaves room for sums and for the product with any usable coordinate.
  constexpr double largest_coefficient = largest_number * largest_number;
  Eigen::Matrix<double, 3, 4> polynomial = Eigen::Matrix<double, 3, 4>::Zero();
  if (has_polynomial()) polynomial = polynomial_.in_world(b);
  take_own_coefficients();
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
  field.keep_volume = options_.keep_volume;
  field.is_halfway = false;
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
          support.weight * coefficient(static_cast<Eigen::Index>(k));
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
