#include "brush/brush_stroke.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace nendo::deform {

namespace {

/// How far a start point reaches, model units.
double reach_of(Eigen::Index point, const Supports& supports) {
  double own = 0.0;
  for (const OwnSupport& one : supports.own)
    if (one.point == point) own = std::max(own, one.support.radius);
  if (own > 0.0) return own;
  double shared = 0.0;
  for (const Support& one : supports.shared)
    shared = std::max(shared, one.radius);
  return shared;
}

} // namespace

BrushStroke::BrushStroke(const BlockLayout& layout, Eigen::Index points,
                         const DeformerOptions& options)
    : layout_(layout), strength_(options.brushes.strength),
      dabs_(options.brushes.rings, options.csrbf.kernel, options.csrbf.keep_volume, options.mask) {
  assert(options.brushes.of_points.size() == static_cast<std::size_t>(points));
  const bool are_mirrored = options.brushes.are_mirrored;
  if (are_mirrored)
    images_.emplace(options.brushes.rings, options.csrbf.kernel, options.csrbf.keep_volume,
                    options.mask);
  const Eigen::Index own = are_mirrored ? points / 2 : points;
  for (Eigen::Index point = 0; point < own; ++point) {
    const Brush brush = options.brushes.of_points[static_cast<std::size_t>(point)];
    if (brush == Brush::pull || brush == Brush::none) continue;
    points_.push_back({point, are_mirrored ? own + point : -1, brush,
                       reach_of(point, options.supports) / layout.unit()});
  }
}

BrushStroke::Way BrushStroke::way_of(Eigen::Index point, const Points& from,
                                     const Points& to) const {
  return {(from.col(point) - layout_.origin()) / layout_.unit(),
          (to.col(point) - layout_.origin()) / layout_.unit()};
}

bool BrushStroke::go(const Points& from, const Points& to, BoundedShape& shape) noexcept {
  bool changed = false;
  if (strength_ == 0.0) return changed;
  for (const OfPoint& one : points_) {
    const Way way = way_of(one.point, from, to);
    if (one.image < 0) {
      changed = go(one, way, nullptr, shape) || changed;
      continue;
    }
    const Way image = way_of(one.image, from, to);
    changed = go(one, way, &image, shape) || changed;
  }
  return changed;
}

bool BrushStroke::go(const OfPoint& one, const Way& way, const Way* image,
                     BoundedShape& shape) noexcept {
  const double length = (way.to - way.from).norm();
  const double longest = longest_dab * one.radius;
  if (!(length > 0.0) || !std::isfinite(length)) return false;
  const int dabs = static_cast<int>(std::min(std::ceil(length / longest), double{max_dabs}));
  bool changed = false;
  for (int k = 0; k < dabs; ++k) {
    const double part = (k + 0.5) / dabs;
    const auto dab_on = [&](const Way& on, double turns) {
      return Dab{one.brush, on.from + part * (on.to - on.from), one.radius,
                 turns * strength_ * std::min(length / dabs, longest)};
    };
    const bool finds = dabs_.find(dab_on(way, 1.0), shape);
    // A mirrored twist turns the other way.
    const double turns = one.brush == Brush::twist ? -1.0 : 1.0;
    const bool image_finds = image != nullptr && images_->find(dab_on(*image, turns), shape);
    changed = (finds && dabs_.write(shape)) || changed;
    changed = (image_finds && images_->write(shape)) || changed;
  }
  return changed;
}

std::vector<Eigen::Index> pulling_points(const BrushOptions& brushes, Eigen::Index points) {
  std::vector<Eigen::Index> pulling;
  for (Eigen::Index point = 0; point < points; ++point)
    if (brushes.of_points.empty() ||
        brushes.of_points[static_cast<std::size_t>(point)] == Brush::pull)
      pulling.push_back(point);
  return pulling;
}

Supports supports_of(const std::vector<Eigen::Index>& points, const Supports& supports) {
  Supports chosen{supports.shared, {}};
  for (const OwnSupport& own : supports.own) {
    const auto found = std::find(points.begin(), points.end(), own.point);
    if (found != points.end()) chosen.own.push_back({found - points.begin(), own.support});
  }
  return chosen;
}

} // namespace nendo::deform
