#include "brush_stroke.hpp"

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
      dabs_(options.brushes.rings, options.csrbf.kernel, options.csrbf.keep_volume) {
  assert(options.brushes.of_points.size() == static_cast<std::size_t>(points));
  for (Eigen::Index point = 0; point < points; ++point) {
    const Brush brush = options.brushes.of_points[static_cast<std::size_t>(point)];
    if (brush == Brush::pull || brush == Brush::none) continue;
    points_.push_back({point, brush, reach_of(point, options.supports) / layout.unit()});
  }
}

bool BrushStroke::go(const Points& from, const Points& to, BoundedShape& shape) noexcept {
  bool changed = false;
  if (strength_ == 0.0) return changed;
  for (const OfPoint& one : points_)
    changed = go(one, (from.col(one.point) - layout_.origin()) / layout_.unit(),
                 (to.col(one.point) - layout_.origin()) / layout_.unit(), shape) ||
              changed;
  return changed;
}

bool BrushStroke::go(const OfPoint& one, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                     BoundedShape& shape) noexcept {
  const double way = (to - from).norm();
  const double longest = longest_dab * one.radius;
  if (!(way > 0.0) || !std::isfinite(way)) return false;
  const int dabs = static_cast<int>(std::min(std::ceil(way / longest), double{most_dabs}));
  bool changed = false;
  for (int k = 0; k < dabs; ++k) {
    const double part = (k + 0.5) / dabs;
    const Dab dab{one.brush, from + part * (to - from), one.radius,
                  strength_ * std::min(way / dabs, longest)};
    changed = dabs_.dab(dab, shape) || changed;
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
