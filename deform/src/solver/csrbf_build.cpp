#include <algorithm>
#include <chrono>
#include <numeric>

#include "geometry/octree_order.hpp"
#include "solver/csrbf_state.hpp"
#include "solver/shared_kernel.hpp"

namespace nendo::deform {

namespace {

/// Seconds since the last question; never asks the clock unless told to.
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

void CsrbfSolver::State::reserve(Eigen::Index points) {
  const auto count = static_cast<std::size_t>(points);
  starts_.resize(3, points);
  ordered_starts_.resize(3, points);
  order_.reserve(count);
  for (Supports* each : {&supports, &ordered_supports_}) {
    each->shared.reserve(1);
    each->own.reserve(count);
  }
  for (Rows* rows : {&right_side_, &solution_, &correction_})
    rows->resize(rows_of(points), 4);
  if (has_polynomial()) polynomial_.reserve(points);
  if (points > lean_size) return;
  usable_ = false;
  if (!systems_[0]) systems_[0] = make_lean_system();
  systems_[0]->reserve(rows_of(points));
}

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
  if (keeps_volume() && n > max_volume_points) return KernelSystem::Assembled::too_dense;
  if (keeps_volume())
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
  if (!keeps_volume() && !own_.evaluate(options_.kernel, ordered_starts_, ordered_supports_))
    return FieldStatus::too_dense;
  const auto assembled = assemble(own_, systems_, system_);
  effort.assembly_s = laps.lap();
  if (assembled == KernelSystem::Assembled::too_dense || !system_->analyse(choices.order))
    return FieldStatus::too_dense;
  effort.analysis_s = laps.lap();
  const double shared_size = SharedKernel(options_.kernel, ordered_supports_).at(0.0);
  const double points = static_cast<double>(std::max<std::size_t>(order_.size(), 1));
  double own_size = own_.trace() / points;
  if (keeps_volume())
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

} // namespace nendo::deform
