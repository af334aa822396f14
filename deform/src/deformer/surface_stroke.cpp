#include <nendo/deform/surface_stroke.hpp>

#include <cassert>
#include <utility>

#include "deformer/surface_shape.hpp"
#include "history/sculpted_parts.hpp"

namespace nendo::deform {

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
