#include <nendo/deform/type1.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include "deformer/cardinal_weights.hpp"
#include "field/masked_step.hpp"
#include "history/sculpted_parts.hpp"
#include "solver/reserve_solver.hpp"

namespace nendo::deform {

namespace {

constexpr int max_midpoint_steps = max_midpoint_fields / 2; // of a way: one and a half radii

std::size_t max_fields_of_type1(const DeformerOptions& options) {
  if (options.csrbf.keeps_volume()) return 2 * static_cast<std::size_t>(max_midpoint_steps);
  return options.injective ? static_cast<std::size_t>(options.injective->max_links) : 1;
}

} // namespace

Type1Deformer::Type1Deformer(Points rest, Eigen::Index control_points,
                             const DeformerOptions& options)
    : Type1Deformer(std::make_unique<SculptedShape>(std::move(rest), options), control_points,
                    options) {}

Type1Deformer::Type1Deformer(std::unique_ptr<SculptedShape> own, Eigen::Index control_points,
                             const DeformerOptions& options)
    : Type1Deformer(*own, control_points, options) {
  own_ = std::move(own);
}

Type1Deformer::Type1Deformer(SculptedShape& shape, Eigen::Index control_points,
                             const DeformerOptions& options)
    : shape_(&shape), starts_(Points::Zero(3, control_points)), rounded_(starts_),
      displacements_(starts_), asked_(starts_),
      supports_(rounded(options.supports, shape.layout())), solver_(options.csrbf),
      field_(zero_field(supports_, control_points, options.csrbf.kernel)),
      fields_(max_fields_of_type1(options), field_),
      evaluator_(std::make_unique<BlockEvaluator>(shape.layout(), field_.centres.cols(),
                                                  options.evaluation)),
      weights_(std::make_unique<CardinalWeights>(shape.layout(), control_points, field_,
                                                 options.csrbf.keeps_volume()
                                                     ? 0 // they would be matrices
                                                     : options.evaluation.weight_bytes)),
      masked_(std::make_unique<MaskedStep>(options.mask)) {
  if (options.csrbf.keeps_volume()) {
    steps_.emplace(control_points, supports_, options.csrbf, max_midpoint_steps);
    evaluator_->reserve_halves(shape.layout());
  } else if (options.injective) {
    chain_.emplace(control_points, supports_, options.csrbf, *options.injective);
  } else {
    reserve_solver(solver_, supports_, control_points);
    return;
  }
  // Not of the present shape, which another thread may be changing.
  linked_ = std::make_unique<BoundedShape>(shape.layout().pack());
}

Type1Deformer::~Type1Deformer() = default;
Type1Deformer::Type1Deformer(Type1Deformer&&) noexcept = default;
Type1Deformer& Type1Deformer::operator=(Type1Deformer&&) noexcept = default;

const BoundedShape& Type1Deformer::rest_shape() const noexcept {
  return shape_->parts().now;
}

FieldStatus Type1Deformer::grab(const Points& starts) {
  assert(starts.cols() == starts_.cols());
  const FieldStatus status = build(starts);
  if (is_solved(status)) take_hold();
  return status;
}

/// On failure everything is as it was.
FieldStatus Type1Deformer::build(const Points& starts) {
  for (Eigen::Index i = 0; i < starts.cols(); ++i)
    asked_.col(i) = shape_->layout().rounded(starts.col(i));
  const FieldStatus status = steps_   ? steps_->grab(asked_)
                             : chain_ ? chain_->grab(asked_)
                                      : solver_.build(asked_, supports_);
  if (!is_solved(status)) {
    // The failed build took the place of the good one.
    if (!steps_ && !chain_ && grabbed_ && status != FieldStatus::not_finite)
      solver_.build(rounded_, supports_);
    return status;
  }
  starts_ = starts;
  rounded_ = asked_;
  return status;
}

/// Of the rest shape, where the solver has been built for.
void Type1Deformer::take_hold() {
  grabbed_ = true;
  forget_applied();
  weights_->build(solver(), rest_shape(), *evaluator_);
}

FieldStatus Type1Deformer::apply(const Points& ends, BlockShape& out) {
  assert(ends.cols() == starts_.cols());
  if (grabbed_ && steps_) return apply_steps(ends, out);
  if (grabbed_ && chain_) return apply_links(ends, out);
  FieldStatus status = FieldStatus::singular;
  if (grabbed_) {
    asked_ = ends - starts_;
    status = solver_.solve(asked_, field_);
    const auto fits = [&] {
      return weights_->is_built() ? weights_->fits(asked_, rest_shape())
                                  : evaluator_->set_field(field_);
    };
    if (is_solved(status) && !fits()) {
      status = FieldStatus::not_finite;
      solver_.solve(displacements_, field_);
    }
    if (is_solved(status)) {
      displacements_ = asked_;
      fields_.clear();
      fields_.push(field_);
    }
  }
  draw(out);
  return status;
}

/// A single link is the plain field, for which there are weights.
FieldStatus Type1Deformer::apply_links(const Points& ends, BlockShape& out) {
  asked_ = rounded_ + (ends - starts_);
  FieldStatus status = chain_->from_start(asked_);
  if (is_solved(status)) {
    fields_.clear();
    const bool any = chain_->next();
    in_links_ = any && chain_->places() != asked_;
    if (in_links_) {
      status = follow_links(*chain_);
    } else {
      field_ = chain_->field();
      if (any) fields_.push(field_);
      displacements_ = asked_ - rounded_;
      while (chain_->next()) {
      }
    }
    status = std::max(status, chain_->report().status);
  }
  draw(out);
  return status;
}

/// On failure, the shape is the last good one.
FieldStatus Type1Deformer::apply_steps(const Points& ends, BlockShape& out) {
  asked_ = ends - starts_;
  FieldStatus status = steps_->go(asked_);
  if (is_solved(status)) {
    fields_.clear();
    displacements_ = asked_;
    in_links_ = steps_->next();
    if (in_links_) status = follow_links(*steps_);
    status = std::max(status, steps_->status());
  }
  draw(out);
  return status;
}

/// From the first, which is made.
template <class Chain>
FieldStatus Type1Deformer::follow_links(Chain& chain) {
  FieldStatus status = FieldStatus::ok;
  linked_->follow(rest_shape());
  do {
    const CsrbfField& link = chain.field();
    masked_->begin(linked_->shape);
    if (evaluator_->set_field(link) && evaluator_->displace(*linked_))
      fields_.push(link);
    else
      status = FieldStatus::not_finite;
    masked_->end(*linked_);
  } while (chain.next());
  return status;
}

void Type1Deformer::draw(BlockShape& out) {
  if (in_links_) {
    out.follow(linked_->shape);
    return;
  }
  const BlockShape& rest = rest_shape().shape;
  if (weights_->is_built()) {
    if (out.block_count() != rest.block_count()) out = rest;
    weights_->apply(displacements_, rest, out, *evaluator_);
  } else {
    evaluator_->set_field(field_);
    evaluator_->displace(rest_shape(), out);
  }
  if (is_masked()) masked_->mask()->apply(rest, out);
}

/// Makes the applied shape the rest shape.
void Type1Deformer::absorb() {
  BoundedShape& rest = shape_->parts().change();
  if (in_links_) {
    rest.follow(*linked_);
    return;
  }
  masked_->begin(rest.shape);
  if (weights_->is_built()) {
    weights_->apply(displacements_, rest.shape, rest.shape, *evaluator_);
    weights_->update_rest_bounds(displacements_, rest);
  } else {
    evaluator_->set_field(field_);
    evaluator_->displace(rest);
  }
  masked_->end(rest);
}

FieldStatus Type1Deformer::commit(const Points& ends) {
  assert(ends.cols() == starts_.cols());
  const FieldStatus status = build(ends);
  if (!is_solved(status)) return status;
  absorb();
  shape_->parts().keep();
  take_hold();
  return status;
}

void Type1Deformer::release(bool is_step) noexcept {
  if (grabbed_ && is_moved()) absorb();
  drop(is_step);
}

void Type1Deformer::drop(bool is_step) noexcept {
  if (is_step) shape_->parts().keep();
  grabbed_ = false;
  forget_applied();
}

void Type1Deformer::forget_applied() noexcept {
  in_links_ = false;
  displacements_.setZero();
  field_.coefficients.setZero();
  field_.polynomial.setZero();
  fields_.clear();
}

FieldStatus Type1Deformer::go(HistoryMove move, const Points& tips) {
  assert(tips.cols() == starts_.cols());
  if (move == HistoryMove::redo && shape_->redo_steps() == 0) return FieldStatus::ok;
  const FieldStatus status = build(tips);
  if (!is_solved(status)) return status;
  if (move == HistoryMove::reset && is_moved()) absorb();
  shape_->parts().go(move);
  take_hold();
  return status;
}

FieldStatus Type1Deformer::take_back(const Points& tips) {
  assert(tips.cols() == starts_.cols());
  const FieldStatus status = build(tips);
  if (!is_solved(status)) return status;
  SculptedShape::Parts& parts = shape_->parts();
  if (parts.history.is_kept()) {
    if (is_moved()) absorb();
    parts.history.keep_undone(parts.now, parts.note);
  }
  take_hold();
  return status;
}

bool Type1Deformer::is_masked() const noexcept {
  return masked_->mask() != nullptr;
}

std::size_t Type1Deformer::weight_bytes() const noexcept {
  return weights_->is_built() ? weights_->bytes_used() : 0;
}

} // namespace nendo::deform
