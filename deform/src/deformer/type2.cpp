#include <nendo/deform/type2.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include <nendo/deform/surface_deformer.hpp>

#include "brush/brush_stroke.hpp"
#include "deformer/fingertip_curve.hpp"
#include "field/masked_step.hpp"
#include "geometry/usable.hpp"
#include "history/sculpted_parts.hpp"
#include "solver/reserve_solver.hpp"

namespace nendo::deform {

namespace {

static_assert(Type2Deformer::max_pieces == FingertipCurve::max_pieces);

constexpr int max_steps_of_piece = 2;
static_assert(2 * max_steps_of_piece * Type2Deformer::max_pieces <= max_midpoint_fields);

/// Of one call.
std::size_t max_fields(const DeformerOptions& options) {
  if (options.csrbf.keeps_volume())
    return std::size_t{2} * max_steps_of_piece * FingertipCurve::max_pieces;
  return static_cast<std::size_t>(options.injective ? options.injective->max_links
                                                    : FingertipCurve::max_pieces);
}

/// Of points that pull along the surface: no field through the air has a part in it.
DeformerOptions without_fields(Eigen::Index control_points) {
  DeformerOptions options;
  options.brushes.of_points.assign(static_cast<std::size_t>(control_points), Brush::none);
  return options;
}

} // namespace

Type2Deformer::Type2Deformer(Points shape, Eigen::Index control_points, double piece_length,
                             const DeformerOptions& options)
    : Type2Deformer(std::make_unique<SculptedShape>(std::move(shape), options), control_points,
                    piece_length, options) {}

Type2Deformer::Type2Deformer(std::unique_ptr<SculptedShape> own, Eigen::Index control_points,
                             double piece_length, const DeformerOptions& options)
    : Type2Deformer(*own, control_points, piece_length, options) {
  own_ = std::move(own);
}

Type2Deformer::Type2Deformer(SculptedShape& shape, Eigen::Index control_points, double piece_length,
                             const DeformerOptions& options)
    : shape_(&shape), curve_(std::make_unique<FingertipCurve>(control_points, piece_length)),
      current_(Points::Zero(3, control_points)), next_(current_),
      pulling_points_(pulling_points(options.brushes, control_points)),
      pulling_(Points::Zero(3, static_cast<Eigen::Index>(pulling_points_.size()))), step_(pulling_),
      rounded_(pulling_),
      supports_(rounded(supports_of(pulling_points_, options.supports), shape.layout())),
      solver_(options.csrbf), field_(zero_field(supports_, pulling_.cols(), options.csrbf.kernel)),
      fields_(max_fields(options), field_),
      evaluator_(std::make_unique<BlockEvaluator>(shape.layout(), field_.centres.cols(),
                                                  options.evaluation)),
      masked_(std::make_unique<MaskedStep>(options.mask)) {
  if (options.brushes.rings && !options.brushes.are_all_pull())
    brushes_ = std::make_unique<BrushStroke>(shape.layout(), control_points, options);
  if (pulling_points_.empty()) return;
  if (options.csrbf.keeps_volume()) {
    steps_.emplace(pulling_.cols(), supports_, options.csrbf, max_steps_of_piece);
    evaluator_->reserve_halves(shape.layout());
    return;
  }
  reserve_solver(solver_, supports_, pulling_.cols());
  if (!options.injective) return;
  chain_.emplace(pulling_.cols(), supports_, options.csrbf, *options.injective);
  max_links_ = options.injective->max_links;
}

Type2Deformer::Type2Deformer(SculptedShape& shape, std::shared_ptr<const SurfaceField> field)
    : Type2Deformer(shape, field->point_count(), 1.0, without_fields(field->point_count())) {
  along_ = std::make_unique<SurfaceStroke>(shape.layout(), std::move(field));
}

Type2Deformer::~Type2Deformer() = default;
Type2Deformer::Type2Deformer(Type2Deformer&&) noexcept = default;
Type2Deformer& Type2Deformer::operator=(Type2Deformer&&) noexcept = default;

FieldStatus Type2Deformer::begin(const Points& tips) {
  shape_->parts().keep();
  return grab(tips);
}

void Type2Deformer::release(bool is_step) noexcept {
  if (is_step) shape_->parts().keep();
  begun_ = false;
  forget_last();
}

/// What the last call applied.
void Type2Deformer::forget_last() noexcept {
  is_brushed_ = false;
  fields_.clear();
  if (along_) along_->clear();
}

FieldStatus Type2Deformer::go(HistoryMove move, const Points& tips) {
  if (move == HistoryMove::redo && shape_->redo_steps() == 0) return FieldStatus::ok;
  const FieldStatus status = grab(tips);
  if (!is_solved(status)) return status;
  shape_->parts().go(move);
  forget_last();
  return status;
}

FieldStatus Type2Deformer::grab(const Points& tips) {
  assert(tips.cols() == current_.cols());
  begun_ = false;
  if (!all_usable(tips)) return FieldStatus::not_finite;
  const FieldStatus status = chain_ ? chain_->grab(pulling(tips)) : FieldStatus::ok;
  if (!is_solved(status)) return status;
  current_ = tips;
  curve_->begin(tips);
  if (along_) along_->begin(tips);
  begun_ = true;
  return status;
}

StrokeResult Type2Deformer::stroke_to(const Points& tips) {
  return follow(tips, &FingertipCurve::extend);
}

StrokeResult Type2Deformer::end_at(const Points& tips) {
  return follow(tips, &FingertipCurve::end_at);
}

/// A piece without a usable field leaves the shape alone; the curve continues after it.
StrokeResult Type2Deformer::follow(const Points& tips, Lead lead) {
  assert(tips.cols() == current_.cols());
  report_ = {};
  forget_last();
  if (!all_usable(tips)) return {FieldStatus::not_finite, 0};
  if (!begun_) return {begin(tips), 0};
  if (along_) {
    const FieldStatus status = along_->go_to(tips, shape_->parts());
    return {status, along_->is_moved() ? 1 : 0};
  }
  StrokeResult result;
  for (((*curve_).*lead)(tips); curve_->next_cut(next_); current_ = next_) {
    const FieldStatus status = apply_piece();
    result.pieces += is_solved(status) ? 1 : 0;
    result.status = std::max(result.status, status); // ordered from good to bad
  }
  return result;
}

/// Those of the start points that pull.
const Points& Type2Deformer::pulling(const Points& tips) {
  for (Eigen::Index i = 0; i < pulling_.cols(); ++i)
    pulling_.col(i) = tips.col(pulling_points_[static_cast<std::size_t>(i)]);
  return pulling_;
}

/// From current_ to next_.
FieldStatus Type2Deformer::apply_piece() {
  FieldStatus status = FieldStatus::ok;
  if (!pulling_points_.empty())
    status = steps_ ? apply_steps() : chain_ ? apply_links() : pull_piece();
  if (brushes_ && brushes_->go(current_, next_, shape_->parts().now)) {
    is_brushed_ = true;
    shape_->parts().is_changed = true;
  }
  return status;
}

/// Sets the start points and the displacements of the piece.
void Type2Deformer::begin_piece() {
  step_ = pulling(next_);
  pulling(current_);
  step_ -= pulling_;
  for (Eigen::Index i = 0; i < pulling_.cols(); ++i)
    rounded_.col(i) = shape_->layout().rounded(pulling_.col(i));
}

FieldStatus Type2Deformer::pull_piece() {
  begin_piece();
  FieldStatus status = solver_.build(rounded_, supports_);
  if (is_solved(status)) status = solver_.solve(step_, field_);
  return is_solved(status) ? std::max(status, apply(field_)) : status;
}

/// As pull_piece(), but in midpoint steps.
FieldStatus Type2Deformer::apply_steps() {
  begin_piece();
  FieldStatus status = steps_->grab(rounded_);
  if (is_solved(status)) status = std::max(status, steps_->go(step_));
  while (is_solved(status) && steps_->next())
    status = std::max(status, apply(steps_->field()));
  return std::max(status, steps_->status());
}

FieldStatus Type2Deformer::apply(const CsrbfField& field) {
  BoundedShape& shape = shape_->parts().change();
  masked_->begin(shape.shape);
  if (!evaluator_->set_field(field) || !evaluator_->displace(shape)) return FieldStatus::not_finite;
  masked_->end(shape);
  fields_.push(field);
  return FieldStatus::ok;
}

/// Fingertips that are held stay where they are; the next piece gives them a goal again.
FieldStatus Type2Deformer::apply_links() {
  FieldStatus status = chain_->from_here(pulling(next_), max_links_ - report_.links);
  while (is_solved(status) && chain_->next())
    status = std::max(status, apply(chain_->field()));
  const ChainReport& piece = chain_->report();
  report_.links += piece.links;
  report_.whole_bound = std::max(report_.whole_bound, piece.whole_bound);
  report_.bound = std::max(report_.bound, piece.bound);
  report_.min_determinant = std::min(report_.min_determinant, piece.min_determinant);
  report_.held_pairs = piece.held_pairs;
  report_.reached = piece.reached;
  report_.status = std::max(report_.status, std::max(status, piece.status));
  return std::max(status, piece.status);
}

bool Type2Deformer::is_masked() const noexcept {
  return masked_->mask() != nullptr;
}

} // namespace nendo::deform
