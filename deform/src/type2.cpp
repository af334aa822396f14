#include <nendo/deform/type2.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "solver_room.hpp"
#include "usable.hpp"

namespace nendo::deform {

namespace {

double farthest(const Points& displacements) {
  return displacements.cols() == 0 ? 0.0 : displacements.colwise().stableNorm().maxCoeff();
}

} // namespace

Type2Deformer::Type2Deformer(Points shape, Eigen::Index control_points, double piece_length,
                             const DeformerOptions& options)
    : layout_(std::move(shape)), shape_(layout_.pack()), current_(Points::Zero(3, control_points)),
      target_(current_), step_(current_), rounded_(current_), asked_(current_),
      supports_(rounded(options.supports, layout_)), piece_length_(piece_length),
      solver_(options.csrbf),
      field_(room_for_field(supports_, control_points, options.csrbf.kernel)),
      evaluator_(layout_, field_.centres.cols(), options.evaluation) {
  assert(piece_length > 0.0);
  make_room(solver_, supports_, control_points);
  if (!options.injective) return;
  chain_.emplace(control_points, supports_, options.csrbf, *options.injective);
  most_links_ = options.injective->most_links;
}

FieldStatus Type2Deformer::begin(const Points& tips) {
  assert(tips.cols() == current_.cols());
  begun_ = all_usable(tips);
  if (!begun_) return FieldStatus::not_finite;
  current_ = tips;
  target_ = tips;
  if (!chain_) return FieldStatus::ok;
  const FieldStatus status = chain_->grab(tips);
  begun_ = is_solved(status);
  return status;
}

StrokeResult Type2Deformer::stroke_to(const Points& tips) {
  assert(tips.cols() == current_.cols());
  report_ = {};
  if (!all_usable(tips)) return {FieldStatus::not_finite, 0};
  if (!begun_) {
    return {begin(tips), 0};
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
  report_ = {};
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
  if (chain_) return apply_links();
  for (Eigen::Index i = 0; i < current_.cols(); ++i)
    rounded_.col(i) = layout_.rounded(current_.col(i));
  FieldStatus status = solver_.build(rounded_, supports_);
  if (is_solved(status)) status = solver_.solve(step_, field_);
  if (!is_solved(status)) return status;
  const bool applied = evaluator_.set_field(field_) && evaluator_.displace(shape_);
  return applied ? status : FieldStatus::not_finite;
}

/// Fingertips that are held stay where they are; the next piece tells them anew where to go.
FieldStatus Type2Deformer::apply_links() {
  asked_ = current_ + step_;
  FieldStatus status = chain_->from_here(asked_, most_links_ - report_.links);
  while (is_solved(status) && chain_->next()) {
    field_ = chain_->field();
    if (!evaluator_.set_field(field_) || !evaluator_.displace(shape_))
      status = FieldStatus::not_finite;
  }
  const ChainReport& piece = chain_->report();
  report_.links += piece.links;
  report_.whole_bound = std::max(report_.whole_bound, piece.whole_bound);
  report_.bound = std::max(report_.bound, piece.bound);
  report_.least_determinant = std::min(report_.least_determinant, piece.least_determinant);
  report_.held_pairs = piece.held_pairs;
  report_.reached = piece.reached;
  report_.status = std::max(report_.status, std::max(status, piece.status));
  return std::max(status, piece.status);
}

} // namespace nendo::deform
