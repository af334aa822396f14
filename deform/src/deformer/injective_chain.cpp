#include <nendo/deform/injective_chain.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "deformer/min_gap.hpp"
#include "geometry/usable.hpp"
#include "solver/reserve_solver.hpp"

namespace nendo::deform {

InjectiveChain::InjectiveChain(Eigen::Index points, Supports supports, CsrbfOptions csrbf,
                               InjectiveOptions options)
    : supports_(std::move(supports)), csrbf_(csrbf), options_(options),
      solvers_{CsrbfSolver(csrbf), CsrbfSolver(csrbf)}, starts_(Points::Zero(3, points)),
      radii_(min_radii(supports_, points)), places_(starts_), wanted_(starts_), allowed_(starts_),
      step_(starts_), tips_(starts_), gaps_(std::make_unique<MinGap>(options.min_gap)),
      field_(zero_field(supports_, points, csrbf.kernel)), piece_(field_) {
  assert(options.max_bound > 0.0 && options.max_bound < 1.0);
  for (CsrbfSolver& solver : solvers_)
    reserve_solver(solver, supports_, points);
  gaps_->reserve(points);
  probe_.reserve(DeterminantProbe::ring_size * points);
}

InjectiveChain::~InjectiveChain() = default;
InjectiveChain::InjectiveChain(InjectiveChain&&) noexcept = default;
InjectiveChain& InjectiveChain::operator=(InjectiveChain&&) noexcept = default;

std::span<const HeldPair> InjectiveChain::walls() const noexcept {
  return gaps_->walls();
}

FieldStatus InjectiveChain::grab(const Points& starts) {
  assert(starts.cols() == starts_.cols());
  const std::size_t other = 1 - kept_;
  const FieldStatus status = solvers_[other].build(starts, supports_);
  if (!is_solved(status)) return status;
  kept_ = other;
  grabbed_ = true;
  starts_ = starts;
  places_ = starts;
  wanted_ = starts;
  at_start_ = true;
  ended_ = true;
  gaps_->begin(starts, radii_);
  report_ = {};
  return status;
}

FieldStatus InjectiveChain::from_start(const Points& ends) noexcept {
  assert(ends.cols() == starts_.cols());
  const bool usable = all_usable(ends);
  if (usable) wanted_ = ends;
  places_ = starts_;
  at_start_ = true;
  gaps_->begin(starts_, radii_);
  const FieldStatus status = go(options_.max_links);
  if (!usable && is_solved(status)) report_.status = FieldStatus::not_finite;
  return report_.status;
}

FieldStatus InjectiveChain::from_here(const Points& ends, int max_links) noexcept {
  assert(ends.cols() == starts_.cols());
  const bool usable = all_usable(ends);
  if (usable) {
    wanted_ = ends;
    gaps_->release(wanted_);
    return go(max_links);
  }
  report_ = {.status = FieldStatus::not_finite};
  ended_ = true;
  return report_.status;
}

FieldStatus InjectiveChain::go(int max_links) noexcept {
  report_ = {};
  field_.coefficients.setZero();
  field_.polynomial.setZero();
  ended_ = false;
  max_links_ = max_links;
  if (!grabbed_) {
    end(FieldStatus::singular);
    return report_.status;
  }
  gaps_->project(wanted_, allowed_);
  probe_.start_round(places_, radii_, csrbf_.kernel);
  return report_.status;
}

bool InjectiveChain::next() noexcept {
  if (ended_) return false;
  if (places_ == allowed_) return end(FieldStatus::ok);
  report_.reached = report_.links < max_links_;
  if (!report_.reached) return end(FieldStatus::ok);
  const FieldStatus status = make_link();
  if (!is_solved(status)) {
    report_.reached = false;
    return end(status);
  }
  if (tips_ == places_) return end(status); // walls all round
  places_ = tips_;
  at_start_ = false;
  report_.status = std::max(report_.status, status); // ordered from good to bad
  report_.bound = std::max(report_.bound, link_bound_);
  ++report_.links;
  probe_.advance(field_);
  return true;
}

/// A way that meets walls has corners. A link continues round them, with its centres where it
/// began: were it cut there, a wall that is only grazed would change how the way is divided, and
/// the shape would jump.
FieldStatus InjectiveChain::make_link() noexcept {
  CsrbfSolver& solver = solvers_[at_start_ ? kept_ : 1 - kept_];
  FieldStatus status = at_start_ ? FieldStatus::ok : solver.build(places_, supports_);
  if (!is_solved(status)) return status;
  tips_ = places_;
  link_bound_ = 0.0;
  for (bool first = true;; first = false) {
    step_ = allowed_ - tips_;
    if (step_.isZero(0.0)) break;
    const FieldStatus solved = solver.solve(step_, piece_);
    const double whole = is_solved(solved) ? lipschitz_bound(piece_) : 0.0;
    if (!is_solved(solved) || std::isinf(whole)) {
      if (first) status = std::isinf(whole) ? FieldStatus::not_finite : solved;
      break;
    }
    status = std::max(status, solved);
    if (first && report_.links == 0) report_.whole_bound = whole;
    // The field is linear in the displacements, and bounds of sums are at most sums of bounds.
    const double free = gaps_->free_part(tips_, allowed_);
    const double left = std::max(options_.max_bound - link_bound_, 0.0);
    const double part = std::min(free, whole > left ? left / whole : 1.0);
    link_bound_ += part * whole;
    extend(part, first);
    const bool held = part == free && free < 1.0 && gaps_->hold(tips_, allowed_, part);
    if (part < 1.0)
      tips_ += part * step_;
    else
      tips_ = allowed_;
    if (!held) break;
    gaps_->project(wanted_, allowed_);
  }
  return status;
}

/// Adds this part of piece_ to the link.
void InjectiveChain::extend(double part, bool first) noexcept {
  if (part < 1.0) {
    piece_.coefficients *= part;
    piece_.polynomial *= part;
  }
  if (first) {
    field_ = piece_;
  } else {
    field_.coefficients += piece_.coefficients;
    field_.polynomial += piece_.polynomial;
  }
}

bool InjectiveChain::end(FieldStatus status) noexcept {
  ended_ = true;
  report_.status = std::max(report_.status, status);
  if (grabbed_) report_.min_determinant = probe_.min_determinant();
  for (const HeldPair& wall : gaps_->walls())
    report_.held_pairs += wall.push > 0.0 ? 1 : 0;
  return false;
}

} // namespace nendo::deform
