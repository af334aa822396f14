#include <nendo/deform/csrbf.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <memory>
#include <numeric>

#include <nendo/base/text.hpp>

#include "geometry/octree_order.hpp"
#include "geometry/usable.hpp"
#include "solver/polynomial_part.hpp"
#include "solver/shared_kernel.hpp"
#include "solver/solver_choices.hpp"

namespace nendo::deform {

namespace {

constexpr std::array<std::string_view, 3> polynomial_names{"none", "constant", "linear"};

/// Seconds since the last call; reads the clock only if `on`.
class Laps {
public:
  explicit Laps(bool on) : on_(on) { lap(); }
  double lap() {
    if (!on_) return 0.0;
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> passed = now - last_;
    last_ = now;
    return passed.count();
  }

private:
  bool on_;
  std::chrono::steady_clock::time_point last_;
};

} // namespace

std::string_view name_of(Polynomial polynomial) noexcept {
  return polynomial_names[static_cast<std::size_t>(polynomial)];
}

std::optional<Polynomial> polynomial_named(std::string_view name) noexcept {
  return enumerator_named<Polynomial>(polynomial_names, name);
}

std::string_view describe(FieldStatus status) noexcept {
  switch (status) {
  case FieldStatus::ok:
    return "ok";
  case FieldStatus::merged:
    return "some control points are so close together that they share their displacements";
  case FieldStatus::singular:
    return "these control points and radii have no usable solution";
  case FieldStatus::too_dense:
    return "too many control points lie within each other's radii to be solved for at once; use "
           "smaller radii or fewer points";
  case FieldStatus::not_finite:
    return "a control point, displacement, radius or weight is not finite, too large, or not "
           "positive";
  }
  return {};
}

class CsrbfSolver::State {
public:
  explicit State(const CsrbfOptions& options) : options_(options) {}

  SolverChoices choices;

  /// Builds for `supports`. The start points and the supports must be usable.
  FieldStatus build(const Points& starts);
  FieldStatus solve(const Points& displacements, CsrbfField& field);

  Supports supports;
  SolverEffort effort;

private:
  using Systems = std::array<std::unique_ptr<KernelSystem>, 3>; ///< lean, dense, sparse

  /// Of M: three per start point, where its entries are matrices.
  Eigen::Index rows_of(Eigen::Index points) const noexcept {
    return options_.keeps_volume() ? 3 * points : points;
  }
  bool has_polynomial() const noexcept {
    return options_.polynomial != Polynomial::none && !options_.keeps_volume();
  }
  /// Returns whether p(x) is solved apart. With own functions it cannot join M, since a solution
  /// would then not be certain for every choice. So p(x) is what the shared functions alone would
  /// make it, and all functions together make up the rest.
  bool is_polynomial_apart() const noexcept { return has_polynomial() && own_.size() > 0; }
  void put_in_order(const Points& starts);
  KernelSystem::Assembled assemble(const OwnFunctions& own, Systems& systems,
                                   KernelSystem*& system);
  FieldStatus factorise(KernelSystem& system, double size);
  FieldStatus factorise_polynomial(double size);
  void solve_in_place(Rows& a, Eigen::Matrix4d& b, const Eigen::Matrix4d& sums);
  void take_right_side(const Points& displacements);
  Eigen::Vector3d coefficient(Eigen::Index place) const;
  void take_own_coefficients();
  bool write(CsrbfField& field, const Eigen::Matrix4d& b);

  CsrbfOptions options_;
  Points starts_;
  std::vector<std::uint32_t> order_; ///< start points, in the order of elimination
  Points ordered_starts_;
  Supports ordered_supports_; ///< points are places in that order
  OwnFunctions own_;
  OwnFunctions no_own_;            ///< stays empty
  Systems systems_;                ///< made when first needed
  KernelSystem* system_ = nullptr; ///< the system of M
  Systems shared_systems_;         ///< systems of its shared part, for a polynomial apart
  KernelSystem* shared_system_ = nullptr;
  PolynomialPart polynomial_;
  bool merged_ = false;
  bool usable_ = false;
  Rows right_side_, solution_, correction_, own_coefficients_;
};

/// Step 1: the start points along an octree, if there are many.
void CsrbfSolver::State::put_in_order(const Points& starts) {
  const Eigen::Index n = starts.cols();
  starts_ = starts;
  ordered_supports_ = supports;
  if (n <= lean_size || choices.order == PointOrder::as_given) {
    order_.resize(static_cast<std::size_t>(n));
    std::iota(order_.begin(), order_.end(), 0U);
    ordered_starts_ = starts;
    return;
  }
  order_ = octree_order(starts);
  std::vector<Eigen::Index> place(order_.size());
  ordered_starts_.resize(3, n);
  for (std::size_t k = 0; k < order_.size(); ++k) {
    ordered_starts_.col(static_cast<Eigen::Index>(k)) = starts.col(order_[k]);
    place[order_[k]] = static_cast<Eigen::Index>(k);
  }
  for (OwnSupport& own : ordered_supports_.own)
    own.point = place[static_cast<std::size_t>(own.point)];
}

/// Step 3 (step 2, the displacements, is solve()'s argument): M, in the storage that suits it.
KernelSystem::Assembled CsrbfSolver::State::assemble(const OwnFunctions& own, Systems& systems,
                                                     KernelSystem*& system) {
  const Eigen::Index n = ordered_starts_.cols();
  const auto assemble_in = [&](std::size_t at, auto make) {
    if (!systems[at]) systems[at] = make();
    system = systems[at].get();
    return system->assemble(options_, ordered_starts_, ordered_supports_, own);
  };
  if (options_.keeps_volume() && n > max_volume_points) return KernelSystem::Assembled::too_dense;
  if (options_.keeps_volume())
    return n <= lean_size ? assemble_in(0, make_lean_system) : assemble_in(1, make_dense_system);
  if (choices.storage == Storage::sparse ||
      (choices.storage == Storage::by_size && n > lean_size)) {
    const bool must = choices.storage == Storage::sparse;
    const auto assembled = assemble_in(2, [&] { return make_sparse_system(must); });
    effort.sparse = assembled != KernelSystem::Assembled::too_dense;
    if (effort.sparse || choices.storage == Storage::sparse) return assembled;
  }
  if (n > max_dense_points) return KernelSystem::Assembled::too_dense;
  return n <= lean_size ? assemble_in(0, make_lean_system) : assemble_in(1, make_dense_system);
}

/// Step 4: Cholesky. size: of the diagonal's entries.
FieldStatus CsrbfSolver::State::factorise(KernelSystem& system, double size) {
  // A ridge keeps clusters factorisable that are not near enough to be merged. It is always there,
  // so that the field does not jump when they form; one step of refinement takes its effect back
  // where M is not near-singular.
  constexpr double min_ridge = 1e-13;
  constexpr double largest_ridge = 1e-8;
  for (double ridge = min_ridge; ridge < largest_ridge; ridge *= 10.0)
    if (system.factorise(ridge * size)) return FieldStatus::ok;
  return FieldStatus::singular;
}

/// Step 4, continued: the polynomial part's Schur complement.
FieldStatus CsrbfSolver::State::factorise_polynomial(double size) {
  KernelSystem* system = system_;
  if (is_polynomial_apart()) {
    if (assemble(no_own_, shared_systems_, shared_system_) == KernelSystem::Assembled::too_dense ||
        !shared_system_->analyse(choices.order))
      return FieldStatus::too_dense;
    if (factorise(*shared_system_, size) != FieldStatus::ok) return FieldStatus::singular;
    system = shared_system_;
  }
  polynomial_.assemble(ordered_starts_, options_.polynomial);
  return polynomial_.eliminate(*system) ? FieldStatus::ok : FieldStatus::singular;
}

FieldStatus CsrbfSolver::State::build(const Points& starts) {
  usable_ = false;
  effort = {};
  Laps laps(starts.cols() > lean_size);
  put_in_order(starts);
  effort.order_s = laps.lap();
  if (!options_.keeps_volume() &&
      !own_.evaluate(options_.kernel, ordered_starts_, ordered_supports_))
    return FieldStatus::too_dense;
  const auto assembled = assemble(own_, systems_, system_);
  effort.assembly_s = laps.lap();
  if (assembled == KernelSystem::Assembled::too_dense || !system_->analyse(choices.order))
    return FieldStatus::too_dense;
  effort.analysis_s = laps.lap();
  const double shared_size = SharedKernel(options_.kernel, ordered_supports_).at(0.0);
  const double points = static_cast<double>(std::max<std::size_t>(order_.size(), 1));
  double own_size = own_.trace() / points;
  if (options_.keeps_volume())
    for (const OwnSupport& own : supports.own)
      own_size += own.support.weight / points;
  FieldStatus status = factorise(*system_, shared_size + own_size);
  if (status == FieldStatus::ok && has_polynomial()) status = factorise_polynomial(shared_size);
  effort.factor_s = laps.lap();
  effort.matrix_entries = system_->matrix_entries();
  effort.factor_entries = system_->factor_entries();
  merged_ = assembled == KernelSystem::Assembled::merged;
  usable_ = status == FieldStatus::ok;
  return usable_ && merged_ ? FieldStatus::merged : status;
}

void CsrbfSolver::State::solve_in_place(Rows& a, Eigen::Matrix4d& b, const Eigen::Matrix4d& sums) {
  system_->solve_in_place(a);
  if (has_polynomial() && !is_polynomial_apart()) b += polynomial_.solve(a, sums);
}

void CsrbfSolver::State::take_right_side(const Points& displacements) {
  right_side_.resize(rows_of(displacements.cols()), 4);
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const auto displacement = displacements.col(order_[k]);
    if (!options_.keeps_volume()) {
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
  if (options_.keeps_volume()) return solution_.block<3, 1>(3 * place, 0);
  return solution_.row(place).head<3>();
}

void CsrbfSolver::State::take_own_coefficients() {
  own_coefficients_.resize(static_cast<Eigen::Index>(supports.own.size()), 4);
  for (std::size_t e = 0; e < supports.own.size(); ++e) {
    auto row = own_coefficients_.row(static_cast<Eigen::Index>(e));
    if (options_.keeps_volume()) {
      const OwnSupport& own = ordered_supports_.own[e];
      row << own_volume_coefficient(options_, ordered_starts_, own, solution_).transpose(), 0.0;
    } else {
      row = own_.coefficient(e, solution_);
    }
  }
}

/// The field in the order in which the start points came; not if it is not finite.
bool CsrbfSolver::State::write(CsrbfField& field, const Eigen::Matrix4d& b) {
  // The square permits sums and for the product with any usable coordinate.
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
