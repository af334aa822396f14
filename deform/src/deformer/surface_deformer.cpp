#include <nendo/deform/surface_deformer.hpp>

#include <cassert>
#include <utility>

#include "deformer/surface_shape.hpp"
#include "geometry/usable.hpp"
#include "history/sculpted_parts.hpp"

namespace nendo::deform {

SurfaceDeformer::SurfaceDeformer(SculptedShape& shape, std::shared_ptr<const SurfaceField> field)
    : shape_(&shape), field_(std::move(field)), starts_(Points::Zero(3, field_->point_count())),
      vectors_(starts_), coefficients_(field_->point_count()) {}

FieldStatus SurfaceDeformer::grab(const Points& starts) {
  if (!all_usable(starts)) return FieldStatus::not_finite;
  take_hold(starts);
  return FieldStatus::ok;
}

void SurfaceDeformer::take_hold(const Points& starts) noexcept {
  assert(starts.cols() == starts_.cols());
  starts_ = starts;
  coefficients_.all.setZero();
  grabbed_ = true;
}

FieldStatus SurfaceDeformer::apply(const Points& ends, BlockShape& out) {
  const BoundedShape& rest = shape_->parts().now;
  if (out.block_count() != rest.shape.block_count()) out = rest.shape;
  FieldStatus status = grabbed_ ? FieldStatus::ok : FieldStatus::singular;
  if (grabbed_ && all_usable(ends)) {
    vectors_ = ends - starts_;
    status = solve_within(*field_, vectors_, rest.extent, coefficients_);
  } else if (grabbed_) {
    status = FieldStatus::not_finite; // the last good shape
  }
  field_->displace(coefficients_, rest.shape, out);
  return status;
}

/// Makes the applied shape the rest shape.
void SurfaceDeformer::absorb() noexcept {
  if (!is_moved()) return;
  BoundedShape& rest = shape_->parts().change();
  displace(*field_, coefficients_, rest.shape, rest);
}

FieldStatus SurfaceDeformer::commit(const Points& ends) {
  if (!all_usable(ends)) return FieldStatus::not_finite;
  absorb();
  shape_->parts().keep();
  take_hold(ends);
  return FieldStatus::ok;
}

void SurfaceDeformer::release(bool is_step) noexcept {
  if (grabbed_) absorb();
  drop(is_step);
}

void SurfaceDeformer::drop(bool is_step) noexcept {
  if (is_step) shape_->parts().keep();
  grabbed_ = false;
  coefficients_.all.setZero();
}

FieldStatus SurfaceDeformer::go(HistoryMove move, const Points& tips) {
  if (move == HistoryMove::redo && shape_->redo_steps() == 0) return FieldStatus::ok;
  if (!all_usable(tips)) return FieldStatus::not_finite;
  if (move == HistoryMove::reset) absorb();
  shape_->parts().go(move);
  take_hold(tips);
  return FieldStatus::ok;
}

FieldStatus SurfaceDeformer::take_back(const Points& tips) {
  if (!all_usable(tips)) return FieldStatus::not_finite;
  SculptedShape::Parts& parts = shape_->parts();
  if (parts.history.is_kept()) {
    absorb();
    parts.history.keep_undone(parts.now, parts.note);
  }
  take_hold(tips);
  return FieldStatus::ok;
}

} // namespace nendo::deform
