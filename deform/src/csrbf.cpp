#include <nendo/deform/csrbf.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "text.hpp"

namespace nendo::deform {

namespace {

/// Polynomial terms.
constexpr Eigen::Index terms = 4;

constexpr std::array<std::pair<Polynomial, std::string_view>, 3> polynomial_names{{
    {Polynomial::none, "none"},
    {Polynomial::constant, "constant"},
    {Polynomial::linear, "linear"},
}};

template <class Derived>
bool all_usable(const Eigen::DenseBase<Derived>& values, double largest = largest_number) {
  return (values.derived().array().abs() <= largest).all(); // false for NaN
}

/// 1 at distance 0, 0 from distance 1 on, with a continuous slope.
double closeness(double distance) noexcept {
  if (!(distance < 1.0)) return 0.0;
  return 1.0 - distance * distance * (3.0 - 2.0 * distance);
}

} // namespace

std::string_view name_of(Polynomial polynomial) noexcept {
  for (const auto& [candidate, name] : polynomial_names)
    if (candidate == polynomial) return name;
  return {};
}

std::optional<Polynomial> polynomial_named(std::string_view name) noexcept {
  for (const auto& [polynomial, candidate] : polynomial_names)
    if (candidate == name) return polynomial;
  return std::nullopt;
}

std::string_view describe(FieldStatus status) noexcept {
  switch (status) {
  case FieldStatus::ok:
    return "ok";
  case FieldStatus::merged:
    return "some control points are so close together that they share their displacements";
  case FieldStatus::singular:
    return "these control points and radii have no usable solution";
  case FieldStatus::not_finite:
    return "a control point, displacement or radius is not finite, too large, or not positive";
  }
  return {};
}

void CsrbfSolver::reserve(Eigen::Index points) {
  const Eigen::Index size = points + terms;
  if (saddle_.rows() == size) return;
  starts_.resize(3, points);
  radii_.resize(points);
  saddle_.resize(size, size);
  solved_basis_.resize(points, terms);
  right_side_.resize(size, 3);
  solution_.resize(size, 3);
  correction_.resize(size, 3);
  scratch_.resize(size, 3);
  if (points > lean_size) return;
  // Which of the two is needed can change from build to build: this allocates both.
  saddle_.setIdentity();
  cholesky_.compute(saddle_.topLeftCorner(points, points));
  elimination_.compute(saddle_);
}

FieldStatus CsrbfSolver::build(const Points& starts, const Eigen::VectorXd& radii) {
  assert(starts.cols() == radii.size());
  if (!all_usable(starts) || !all_usable(radii) || !(radii.array() > 0.0).all())
    return FieldStatus::not_finite;
  reserve(starts.cols());
  starts_ = starts;
  radii_ = radii;
  symmetric_ = starts.cols() == 0 || (radii.array() == radii[0]).all();
  assemble();
  merge_near();
  usable_ = symmetric_ ? factorise_symmetric() : factorise_general();
  return usable_ ? status_if_solved() : FieldStatus::singular;
}

/// The saddle-point matrix [A Q; Q^T U], with q(c_i) in the rows of Q and U = 0 but for
/// undetermined terms.
void CsrbfSolver::assemble() {
  const Eigen::Index n = starts_.cols();
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i)
      saddle_(i, j) =
          wendland(options_.kernel, (starts_.col(i) - starts_.col(j)).norm() / radii_[j]);
  auto basis = saddle_.topRightCorner(n, terms);
  const Eigen::Vector3d middle =
      n > 0 ? Eigen::Vector3d(starts_.rowwise().mean()) : Eigen::Vector3d::Zero();
  double spread = 1.0 / largest_number;
  for (Eigen::Index i = 0; i < n; ++i)
    spread = std::max(spread, (starts_.col(i) - middle).norm());
  for (Eigen::Index i = 0; i < n; ++i)
    basis.row(i) << 1.0, (starts_.col(i) - middle).transpose() / spread;
  Eigen::Matrix4d normalise = Eigen::Matrix4d::Zero(); // (1, x) -> (1, (x - middle) / spread)
  normalise(0, 0) = 1.0;
  normalise.block<3, 1>(1, 0) = -middle / spread;
  normalise.block<3, 3>(1, 1).diagonal().setConstant(1.0 / spread);
  orthonormalise(normalise);
}

/// Turns the basis into an orthonormal one on the start points. Terms that the start points do not
/// determine (of coplanar points: along the normal) become zero columns with a 1 on the diagonal,
/// so that their weight is 0.
void CsrbfSolver::orthonormalise(const Eigen::Matrix4d& normalise) {
  // Eigenvalues are squares: this keeps directions in which the points spread more than 1e-6 of
  // their size.
  constexpr double least_eigenvalue = 1e-12;
  const Eigen::Index n = starts_.cols();
  auto basis = saddle_.topRightCorner(n, terms);
  if (options_.polynomial == Polynomial::none) basis.setZero();
  if (options_.polynomial == Polynomial::constant) basis.rightCols<3>().setZero();
  Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
  for (Eigen::Index i = 0; i < n; ++i)
    gram.noalias() += basis.row(i).transpose() * basis.row(i);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(gram);
  const double least = least_eigenvalue * static_cast<double>(n);
  Eigen::Matrix4d change = eigen.eigenvectors();
  auto undetermined = saddle_.bottomRightCorner(terms, terms);
  undetermined.setZero();
  for (Eigen::Index k = 0; k < terms; ++k) {
    const double value = eigen.eigenvalues()[k];
    const bool determined = value > least;
    change.col(k) *= determined ? 1.0 / std::sqrt(value) : 0.0;
    undetermined(k, k) = determined ? 0.0 : 1.0;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::RowVector4d changed = basis.row(i) * change;
    basis.row(i) = changed;
    saddle_.block<terms, 1>(n, i) = changed.transpose();
  }
  world_to_basis_.noalias() = change.transpose() * normalise;
}

/// Ties the coefficients of near start points together: row i of the equations becomes
///   s(c_i) + w (a_i - a_j) = g_i,
/// with w from 0 at the merge distance to 1 where c_i and c_j coincide. These two thus get the
/// mean, others keep their equations, and the matrix stays regular. Smoothing the displacements
/// instead would not be enough: two equal values at vanishing distance demand a zero slope along
/// their connection, which turns with it, and the field would jump.
void CsrbfSolver::merge_near() {
  // The matrix's own resistance to a difference of a_i and a_j at the merge distance. The ties
  // start on that scale, not on that of 1, or all would happen within a hair of that distance.
  const double stiffness = 1.0 - wendland(options_.kernel, options_.merge_fraction);
  merged_ = false;
  for (Eigen::Index j = 1; j < starts_.cols(); ++j)
    for (Eigen::Index i = 0; i < j; ++i) {
      const double reach = options_.merge_fraction * std::max(radii_[i], radii_[j]);
      const double distance = (starts_.col(i) - starts_.col(j)).norm();
      const double near = distance > 0.0 ? closeness(distance / reach) : 1.0;
      const double tie = near < 1.0 ? near * stiffness / (1.0 - near + stiffness) : 1.0;
      if (tie == 0.0) continue;
      saddle_(i, i) += tie;
      saddle_(j, j) += tie;
      saddle_(i, j) -= tie;
      saddle_(j, i) -= tie;
      merged_ = true;
    }
}

bool CsrbfSolver::factorise_symmetric() {
  // A ridge keeps clusters factorisable that are not near enough to be merged. It is always there,
  // so that the field does not jump when they form; one step of refinement takes its effect back
  // where A is not near-singular.
  constexpr double least_ridge = 1e-13;
  constexpr double largest_ridge = 1e-8;
  const Eigen::Index n = starts_.cols();
  auto diagonal = saddle_.diagonal().head(n);
  auto original = scratch_.col(0).head(n);
  original = diagonal;
  bool done = n == 0;
  for (double ridge = least_ridge; !done && ridge < largest_ridge; ridge *= 10.0) {
    diagonal = original.array() + ridge;
    cholesky_.compute(saddle_.topLeftCorner(n, n));
    done = cholesky_.info() == Eigen::Success;
  }
  diagonal = original;
  if (!done) return false;
  solved_basis_ = saddle_.topRightCorner(n, terms);
  if (n > 0) cholesky_.solveInPlace(solved_basis_);
  Eigen::Matrix4d schur = saddle_.bottomRightCorner(terms, terms);
  schur.noalias() += saddle_.bottomLeftCorner(terms, n) * solved_basis_;
  schur_.compute(schur);
  return schur_.info() == Eigen::Success;
}

bool CsrbfSolver::factorise_general() {
  // Beyond this the interpolation would keep fewer than four digits.
  constexpr double least_pivot = 1e-12;
  elimination_.compute(saddle_);
  const auto pivots = elimination_.matrixLU().diagonal();
  return pivots.cwiseAbs().minCoeff() > least_pivot * elimination_.maxPivot();
}

/// Solves for the right side [g; s] in place, giving [a; b].
void CsrbfSolver::solve_in_place(Eigen::MatrixX3d& values) {
  const Eigen::Index n = starts_.cols();
  if (!symmetric_) {
    scratch_.noalias() = elimination_.permutationP() * values;
    elimination_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(scratch_);
    elimination_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(scratch_);
    values.noalias() = elimination_.permutationQ() * scratch_;
    return;
  }
  // a = A^-1 (g - Q b) with (Q^T A^-1 Q) b = Q^T A^-1 g - s.
  auto a = values.topRows(n);
  auto b = values.bottomRows<terms>();
  if (n > 0) cholesky_.solveInPlace(a);
  Eigen::Matrix<double, terms, 3> reduced = -b;
  reduced.noalias() += saddle_.bottomLeftCorner(terms, n) * a;
  schur_.solveInPlace(reduced);
  b = reduced;
  a.noalias() -= solved_basis_ * reduced;
}

FieldStatus CsrbfSolver::solve(const Points& displacements, CsrbfField& field) {
  assert(displacements.cols() == starts_.cols());
  if (!usable_) return FieldStatus::singular;
  if (!all_usable(displacements)) return FieldStatus::not_finite;
  const Eigen::Index n = starts_.cols();
  right_side_.setZero();
  right_side_.topRows(n) = displacements.transpose();
  solution_ = right_side_;
  solve_in_place(solution_);
  correction_ = right_side_;
  correction_.noalias() -= saddle_ * solution_;
  solve_in_place(correction_);
  solution_ += correction_;
  const Eigen::Matrix<double, 3, 4> polynomial =
      solution_.bottomRows<terms>().transpose() * world_to_basis_;
  // The square leaves room for sums and for the product with any usable coordinate.
  constexpr double largest_coefficient = largest_number * largest_number;
  if (!all_usable(solution_, largest_coefficient) || !all_usable(polynomial, largest_coefficient))
    return FieldStatus::not_finite;
  field.kernel = options_.kernel;
  field.centres = starts_;
  field.radii = radii_;
  field.coefficients = solution_.topRows(n).transpose();
  field.polynomial = polynomial;
  return status_if_solved();
}

} // namespace nendo::deform
