#include <nendo/deform/surface_deformer.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/surface_field.hpp>

#include "field/block_evaluator.hpp"
#include "geometry/usable.hpp"
#include "history/sculpted_parts.hpp"

namespace nendo::deform {

namespace {

/// Solves for these control vectors (3 by #points, model units) of a shape whose coordinates are at
/// most `extent`. If float could not hold what they make of it, the coefficients are 0 and the
/// status is not_finite.
FieldStatus solve_within(const SurfaceField& field, const Points& vectors, double extent,
                         SurfaceField::Coefficients& coefficients) noexcept {
  field.solve(vectors, coefficients);
  // The functions are at most 1, and affine maps of rigid parts reach a few times farther.
  const double most = 1e3 * static_cast<double>(coefficients.all.cols()) *
                      static_cast<double>(coefficients.all.cwiseAbs().maxCoeff());
  if (extent + most <= max_units) return FieldStatus::ok;
  coefficients.all.setZero();
  return FieldStatus::not_finite;
}

/// Writes to = from + s, with the bounds. `from` may be the shape of `to`. Does not allocate.
void displace(const SurfaceField& field, const SurfaceField::Coefficients& by,
              const BlockShape& from, BoundedShape& to) noexcept {
  field.displace(by, from, to.shape);
  for (std::size_t block = 0; block < to.bounds.size(); ++block) {
    if (!field.reaches(block)) continue;
    to.bounds[block] = bounds_of(to.shape[block]);
    for (const float side : to.bounds[block].sides)
      to.extent = std::max(to.extent, std::abs(static_cast<double>(side)));
  }
}

} // namespace

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

// Not a copy of the present shape, which another thread may be changing.
SurfaceStroke::SurfaceStroke(const BlockLayout& layout, std::shared_ptr<const SurfaceField> field)
    : field_(std::move(field)), starts_(Points::Zero(3, field_->point_count())), way_(starts_),
      first_(layout.pack()), whole_(field_->point_count()), next_(whole_), step_(whole_) {}

void SurfaceStroke::begin(const Points& tips) noexcept {
  assert(tips.cols() == starts_.cols());
  starts_ = tips;
  whole_.all.setZero();
  has_first_ = false;
}

FieldStatus SurfaceStroke::go_to(const Points& tips, SculptedShape::Parts& parts) noexcept {
  clear();
  if (!std::exchange(has_first_, true)) {
    first_.follow(parts.now.shape);
    first_extent_ = parts.now.extent;
  }
  way_ = tips - starts_;
  const FieldStatus status = solve_within(*field_, way_, first_extent_, next_);
  if (!is_solved(status)) return status;
  step_.all = next_.all - whole_.all;
  if (!is_moved()) return status;
  std::swap(whole_, next_);
  displace(*field_, whole_, first_, parts.change());
  return status;
}

} // namespace nendo::deform
