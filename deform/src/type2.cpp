#include <nendo/deform/type2.hpp>

#include <cassert>
#include <cmath>
#include <utility>

#include "text.hpp"

namespace nendo::deform {

namespace {

double farthest(const Points& displacements) {
  return displacements.cols() == 0 ? 0.0 : displacements.colwise().stableNorm().maxCoeff();
}

bool are_usable(const Points& tips) {
  return (tips.array().abs() <= largest_number).all(); // false for NaN
}

} // namespace

Type2Deformer::Type2Deformer(Points shape, Eigen::Index control_points, double radius,
                             double piece_length, CsrbfOptions options,
                             const EvaluationOptions& evaluation)
    : layout_(std::move(shape)), shape_(layout_.pack()), current_(Points::Zero(3, control_points)),
      target_(current_), step_(current_), rounded_(current_),
      radii_(Eigen::VectorXd::Constant(control_points, layout_.rounded_radius(radius))),
      piece_length_(piece_length), solver_(options), field_{.kernel = options.kernel,
                                                            .centres = current_,
                                                            .radii = radii_,
                                                            .coefficients = step_},
      evaluator_(layout_, control_points, evaluation) {
  assert(piece_length > 0.0);
  solver_.reserve(control_points);
}

void Type2Deformer::begin(const Points& tips) {
  assert(tips.cols() == current_.cols());
  begun_ = are_usable(tips);
  if (!begun_) return;
  current_ = tips;
  target_ = tips;
}

StrokeResult Type2Deformer::stroke_to(const Points& tips) {
  assert(tips.cols() == current_.cols());
  if (!are_usable(tips)) return {FieldStatus::not_finite, 0};
  if (!begun_) {
    begin(tips);
    return {};
  }
  target_ = tips;
  step_ = target_ - current_;
  const double length = farthest(step_);
  if (length > most_pieces * piece_length_) return advance_to_target(most_pieces);
  const int pieces = static_cast<int>(length / piece_length_);
  if (pieces == 0) return {};
  step_ *= piece_length_ / length;
  return advance(pieces);
}

StrokeResult Type2Deformer::finish() {
  if (!begun_) return {};
  step_ = target_ - current_;
  if (farthest(step_) == 0.0) return {};
  return advance_to_target(1);
}

/// In equal pieces; step_ is the whole way.
StrokeResult Type2Deformer::advance_to_target(int pieces) {
  step_ /= pieces;
  const StrokeResult result = advance(pieces);
  current_ = target_; // what rounding left
  return result;
}

/// By step_, so many times. A piece without a usable field leaves the shape alone; the curve goes
/// on behind it.
StrokeResult Type2Deformer::advance(int pieces) {
  StrokeResult result;
  for (int piece = 0; piece < pieces; ++piece) {
    const FieldStatus status = apply_piece();
    result.pieces += is_solved(status) ? 1 : 0;
    if (status > result.status) result.status = status; // ordered from good to bad
    current_ += step_;
  }
  return result;
}

/// From current_ by step_.
FieldStatus Type2Deformer::apply_piece() {
  for (Eigen::Index i = 0; i < current_.cols(); ++i)
    rounded_.col(i) = layout_.rounded(current_.col(i));
  FieldStatus status = solver_.build(rounded_, radii_);
  if (is_solved(status)) status = solver_.solve(step_, field_);
  if (!is_solved(status)) return status;
  const bool applied = evaluator_.set_field(field_) && evaluator_.displace(shape_);
  return applied ? status : FieldStatus::not_finite;
}

} // namespace nendo::deform
