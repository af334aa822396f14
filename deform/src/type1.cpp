#include <nendo/deform/type1.hpp>

#include <cassert>
#include <utility>

#include "cardinal_weights.hpp"

namespace nendo::deform {

Type1Deformer::Type1Deformer(Points rest, Eigen::Index control_points, double radius,
                             CsrbfOptions options, const EvaluationOptions& evaluation)
    : layout_(std::move(rest)), rest_(layout_.pack()), starts_(Points::Zero(3, control_points)),
      rounded_(starts_), displacements_(starts_), asked_(starts_),
      radii_(Eigen::VectorXd::Constant(control_points, layout_.rounded_radius(radius))),
      solver_(options), field_{.kernel = options.kernel,
                               .centres = starts_,
                               .radii = radii_,
                               .coefficients = displacements_},
      evaluator_(layout_, control_points, evaluation),
      weights_(
          std::make_unique<CardinalWeights>(layout_, control_points, evaluation.weight_bytes)) {
  solver_.reserve(control_points);
}

Type1Deformer::~Type1Deformer() = default;
Type1Deformer::Type1Deformer(Type1Deformer&&) noexcept = default;
Type1Deformer& Type1Deformer::operator=(Type1Deformer&&) noexcept = default;

FieldStatus Type1Deformer::grab(const Points& starts) {
  assert(starts.cols() == starts_.cols());
  for (Eigen::Index i = 0; i < starts.cols(); ++i)
    asked_.col(i) = layout_.rounded(starts.col(i));
  const FieldStatus status = solver_.build(asked_, radii_);
  if (is_solved(status)) {
    starts_ = starts;
    rounded_ = asked_;
    take_hold();
  } else if (grabbed_ && status == FieldStatus::singular) {
    solver_.build(rounded_, radii_); // the failed build took the place of the good one
  }
  return status;
}

/// Of the rest shape, where the solver has been built for.
void Type1Deformer::take_hold() {
  grabbed_ = true;
  displacements_.setZero();
  field_.coefficients.setZero();
  field_.polynomial.setZero();
  weights_->build(solver_, rest_, evaluator_);
}

FieldStatus Type1Deformer::apply(const Points& ends, BlockShape& out) {
  assert(ends.cols() == starts_.cols());
  FieldStatus status = FieldStatus::singular;
  if (grabbed_) {
    asked_ = ends - starts_;
    status = solver_.solve(asked_, field_);
    const auto fits = [&] {
      return weights_->is_built() ? weights_->fits(asked_, rest_) : evaluator_.set_field(field_);
    };
    if (is_solved(status) && !fits()) {
      status = FieldStatus::not_finite;
      solver_.solve(displacements_, field_);
    }
    if (is_solved(status)) displacements_ = asked_;
  }
  draw(out);
  return status;
}

void Type1Deformer::draw(BlockShape& out) {
  if (!weights_->is_built()) {
    evaluator_.set_field(field_);
    evaluator_.displace(rest_, out);
    return;
  }
  if (out.block_count() != rest_.shape.block_count()) out = rest_.shape;
  weights_->apply(displacements_, rest_.shape, out, evaluator_);
}

FieldStatus Type1Deformer::commit(const Points& ends) {
  assert(ends.cols() == starts_.cols());
  for (Eigen::Index i = 0; i < ends.cols(); ++i)
    asked_.col(i) = layout_.rounded(ends.col(i));
  const FieldStatus status = solver_.build(asked_, radii_);
  if (!is_solved(status)) {
    if (grabbed_ && status == FieldStatus::singular) solver_.build(rounded_, radii_);
    return status;
  }
  if (weights_->is_built()) {
    weights_->apply(displacements_, rest_.shape, rest_.shape, evaluator_);
    weights_->update_rest_bounds(displacements_, rest_);
  } else {
    evaluator_.set_field(field_);
    evaluator_.displace(rest_);
  }
  starts_ = ends;
  rounded_ = asked_;
  take_hold();
  return status;
}

std::size_t Type1Deformer::weight_bytes() const noexcept {
  return weights_->is_built() ? weights_->bytes_used() : 0;
}

} // namespace nendo::deform
