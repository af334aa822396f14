#include <nendo/deform/type1.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include "cardinal_weights.hpp"
#include "shape_history.hpp"
#include "solver_room.hpp"

namespace nendo::deform {

Type1Deformer::Type1Deformer(Points rest, Eigen::Index control_points,
                             const DeformerOptions& options)
    : layout_(std::move(rest)), rest_(std::make_unique<BoundedShape>(layout_.pack())),
      starts_(Points::Zero(3, control_points)), rounded_(starts_), displacements_(starts_),
      asked_(starts_), supports_(rounded(options.supports, layout_)), solver_(options.csrbf),
      field_(room_for_field(supports_, control_points, options.csrbf.kernel)),
      fields_(options.injective ? static_cast<std::size_t>(options.injective->most_links) : 1,
              field_),
      evaluator_(
          std::make_unique<BlockEvaluator>(layout_, field_.centres.cols(), options.evaluation)),
      weights_(std::make_unique<CardinalWeights>(layout_, control_points, field_,
                                                 options.evaluation.weight_bytes)),
      history_(
          std::make_unique<ShapeHistory>(rest_->shape, options.undo_bytes, options.undo_memory)) {
  if (options.injective) {
    chain_.emplace(control_points, supports_, options.csrbf, *options.injective);
    linked_ = std::make_unique<BoundedShape>(*rest_);
  } else {
    make_room(solver_, supports_, control_points);
  }
}

Type1Deformer::~Type1Deformer() = default;
Type1Deformer::Type1Deformer(Type1Deformer&&) noexcept = default;
Type1Deformer& Type1Deformer::operator=(Type1Deformer&&) noexcept = default;

const BlockShape& Type1Deformer::rest() const noexcept {
  return rest_->shape;
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
    asked_.col(i) = layout_.rounded(starts.col(i));
  const FieldStatus status = chain_ ? chain_->grab(asked_) : solver_.build(asked_, supports_);
  if (!is_solved(status)) {
    // The failed build took the place of the good one.
    if (!chain_ && grabbed_ && status != FieldStatus::not_finite)
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
  in_links_ = false;
  displacements_.setZero();
  field_.coefficients.setZero();
  field_.polynomial.setZero();
  fields_.clear();
  weights_->build(solver(), *rest_, *evaluator_);
}

FieldStatus Type1Deformer::apply(const Points& ends, BlockShape& out) {
  assert(ends.cols() == starts_.cols());
  if (grabbed_ && chain_) return apply_links(ends, out);
  FieldStatus status = FieldStatus::singular;
  if (grabbed_) {
    asked_ = ends - starts_;
    status = solver_.solve(asked_, field_);
    const auto fits = [&] {
      return weights_->is_built() ? weights_->fits(asked_, *rest_) : evaluator_->set_field(field_);
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
      status = follow_links();
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

/// From the first, which is made.
FieldStatus Type1Deformer::follow_links() {
  FieldStatus status = FieldStatus::ok;
  linked_->follow(*rest_);
  do {
    const CsrbfField& link = chain_->field();
    if (evaluator_->set_field(link) && evaluator_->displace(*linked_))
      fields_.push(link);
    else
      status = FieldStatus::not_finite;
  } while (chain_->next());
  return status;
}

void Type1Deformer::draw(BlockShape& out) {
  if (in_links_) {
    out.follow(linked_->shape);
    return;
  }
  if (!weights_->is_built()) {
    evaluator_->set_field(field_);
    evaluator_->displace(*rest_, out);
    return;
  }
  if (out.block_count() != rest_->shape.block_count()) out = rest_->shape;
  weights_->apply(displacements_, rest_->shape, out, *evaluator_);
}

FieldStatus Type1Deformer::commit(const Points& ends) {
  assert(ends.cols() == starts_.cols());
  const FieldStatus status = build(ends);
  if (!is_solved(status)) return status;
  if (in_links_) {
    rest_->follow(*linked_);
  } else if (weights_->is_built()) {
    weights_->apply(displacements_, rest_->shape, rest_->shape, *evaluator_);
    weights_->update_rest_bounds(displacements_, *rest_);
  } else {
    evaluator_->set_field(field_);
    evaluator_->displace(*rest_);
  }
  history_->keep(rest_->shape);
  take_hold();
  return status;
}

FieldStatus Type1Deformer::undo(const Points& tips) {
  assert(tips.cols() == starts_.cols());
  const FieldStatus status = build(tips);
  if (!is_solved(status)) return status;
  history_->undo(*rest_);
  take_hold();
  return status;
}

FieldStatus Type1Deformer::redo(const Points& tips) {
  assert(tips.cols() == starts_.cols());
  if (redo_steps() == 0) return FieldStatus::ok;
  const FieldStatus status = build(tips);
  if (!is_solved(status)) return status;
  history_->redo(*rest_);
  take_hold();
  return status;
}

std::size_t Type1Deformer::undo_steps() const noexcept {
  return history_->steps();
}

std::size_t Type1Deformer::redo_steps() const noexcept {
  return history_->undone();
}

std::size_t Type1Deformer::forgotten_steps() const noexcept {
  return history_->forgotten();
}

std::size_t Type1Deformer::weight_bytes() const noexcept {
  return weights_->is_built() ? weights_->bytes_used() : 0;
}

} // namespace nendo::deform
