#include "brush/brush_stroke.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include <nendo/deform/volume_kernel.hpp>

namespace nendo::deform {

namespace {

/// The square of the distance from there to the nearest place within the bounds.
double square_distance(const BlockBounds& bounds, const Eigen::Vector3d& from) noexcept {
  double sum = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = static_cast<double>(bounds.sides[axis]);
    const double high = -static_cast<double>(bounds.sides[axis + 4]);
    const double at = from[static_cast<Eigen::Index>(axis)];
    const double outside = std::max({low - at, at - high, 0.0});
    sum += outside * outside;
  }
  return sum;
}

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

BrushDabs::BrushDabs(std::shared_ptr<const VertexRings> rings, Wendland kernel, double keep_volume,
                     std::shared_ptr<const VertexMask> mask)
    : rings_(std::move(rings)), kernel_(kernel), keep_volume_(keep_volume), mask_(std::move(mask)) {
  reached_.reserve(rings_->vertex_count());
}

bool BrushDabs::find(const Dab& dab, const BoundedShape& shape) noexcept {
  // A vertex moves at most a few radii, whatever the brush.
  if (!(shape.extent + 8.0 * dab.radius + std::abs(dab.way) <= max_units)) return false;
  if (!gather(dab, shape)) return false;
  if (dab.brush == Brush::smooth) {
    smooth(dab, shape.shape);
    return true;
  }
  if (dab.brush == Brush::inflate) {
    move_along_normals(dab.way);
    return true;
  }
  const double turns = dab.way / dab.radius;
  if (dab.brush == Brush::scale) {
    move_each(shape.shape, [&](const Eigen::Vector3d& x, double weight) -> Eigen::Vector3d {
      return std::expm1(turns * weight) * (x - dab.centre);
    });
    return true;
  }
  if (!find_plane(shape.shape)) return false;
  const double part = -std::expm1(-2.0 * std::abs(turns));
  move_each(shape.shape, [&](const Eigen::Vector3d& x, double weight) -> Eigen::Vector3d {
    if (dab.brush == Brush::push) return -dab.way * pushed((x - dab.centre) / dab.radius, weight);
    if (dab.brush == Brush::flatten) return -part * weight * normal_.dot(x - middle_) * normal_;
    if (dab.brush == Brush::pinch) {
      const Eigen::Vector3d from_centre = x - dab.centre;
      return std::expm1(-turns * weight) * (from_centre - normal_.dot(from_centre) * normal_);
    }
    const Eigen::Vector3d from_axis = x - middle_;
    return Eigen::AngleAxisd(turns * weight, normal_) * from_axis - from_axis;
  });
  return true;
}

/// Returns false if there is nothing.
bool BrushDabs::gather(const Dab& dab, const BoundedShape& shape) noexcept {
  reached_.clear();
  const double square_radius = dab.radius * dab.radius;
  const std::size_t vertices = rings_->vertex_count();
  for (std::size_t block = 0; block < shape.shape.block_count(); ++block) {
    if (!(square_distance(shape.bounds[block], dab.centre) < square_radius)) continue;
    const float* const held = mask_ ? mask_->of_block(block) : nullptr;
    const std::size_t first = block * block_size;
    for (std::size_t place = first; place < std::min(first + block_size, vertices); ++place) {
      const float free = held == nullptr ? 1.0F : held[place - first];
      if (free <= 0.0F) continue; // not even by an addition of 0
      const double square =
          (vertex_at(shape.shape, place).cast<double>() - dab.centre).squaredNorm();
      if (!(square < square_radius)) continue;
      Reached& reached = reached_.emplace_back(); // reserved for all
      reached.place = static_cast<std::uint32_t>(place);
      reached.weight = free * static_cast<float>(wendland(kernel_, std::sqrt(square) / dab.radius));
    }
  }
  for (Reached& one : reached_)
    one.normal = area_normal(*rings_, shape.shape, one.place).cast<float>();
  return !reached_.empty();
}

/// The plane that fits the reached surface. Returns false if it has no area, or no side.
bool BrushDabs::find_plane(const BlockShape& shape) noexcept {
  double whole = 0.0;
  middle_.setZero();
  normal_.setZero();
  for (const Reached& one : reached_) {
    const Eigen::Vector3d normal = one.normal.cast<double>();
    const double part = static_cast<double>(one.weight) * normal.norm();
    whole += part;
    middle_ += part * vertex_at(shape, one.place).cast<double>();
    normal_ += static_cast<double>(one.weight) * normal;
  }
  // Where a thin part is reached from both sides, the normals cancel each other.
  const double length = normal_.norm();
  if (!(length > 1e-3 * whole)) return false;
  middle_ /= whole;
  normal_ /= length;
  return true;
}

/// Where the mean normal leads there: u, in radii from the centre.
Eigen::Vector3d BrushDabs::pushed(const Eigen::Vector3d& u, double weight) const noexcept {
  if (keep_volume_ <= 0.0) return weight * normal_;
  const VolumeKernel kernel = volume_kernel(kernel_, keep_volume_, u.norm());
  return kernel.identity * normal_ + kernel.offset * u.dot(normal_) * u;
}

template <class MoveOf>
void BrushDabs::move_each(const BlockShape& shape, const MoveOf& move_of) noexcept {
  for (Reached& one : reached_)
    one.move = move_of(vertex_at(shape, one.place).cast<double>(), static_cast<double>(one.weight))
                   .template cast<float>();
}

void BrushDabs::move_along_normals(double way) noexcept {
  for (Reached& one : reached_) {
    const float length = one.normal.norm();
    if (!(length > 0.0F)) continue; // no triangle has an area here
    one.move = one.normal * (static_cast<float>(way) * one.weight / length);
  }
}

void BrushDabs::smooth(const Dab& dab, const BlockShape& shape) noexcept {
  const double part = -std::expm1(-2.0 * std::abs(dab.way) / dab.radius);
  for (Reached& one : reached_) {
    const auto neighbours = rings_->neighbours(one.place);
    if (neighbours.empty()) continue;
    const Eigen::Vector3f here = vertex_at(shape, one.place);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const std::uint32_t neighbour : neighbours)
      sum += vertex_at(shape, neighbour) - here;
    one.move =
        sum * (static_cast<float>(part) * one.weight / static_cast<float>(neighbours.size()));
  }
  keep_volume();
}

/// Moves all along their normals by what gives back the volume that the moves take, to first order
/// in the moves: the derivative of the volume by a vertex's place is a sixth of its area normal.
void BrushDabs::keep_volume() noexcept {
  double taken = 0.0;
  double given = 0.0; // by moves of the weights, along the normals
  for (const Reached& one : reached_) {
    taken -= static_cast<double>(one.normal.dot(one.move));
    given += static_cast<double>(one.weight * one.normal.norm());
  }
  if (!(given > 0.0)) return;
  const float way = static_cast<float>(taken / given);
  for (Reached& one : reached_) {
    const float length = one.normal.norm();
    if (length > 0.0F) one.move += one.normal * (way * one.weight / length);
  }
}

bool BrushDabs::write(BoundedShape& shape) const noexcept {
  for (const Reached& one : reached_)
    if (!one.move.allFinite()) return false;
  const std::size_t last = rings_->vertex_count() - 1;
  for (auto one = reached_.begin(); one != reached_.end();) {
    const std::size_t block_number = one->place / block_size;
    VertexBlock& block = shape.shape.data()[block_number];
    for (; one != reached_.end() && one->place / block_size == block_number; ++one) {
      // The rest of the last block repeats its last vertex.
      const std::size_t end = one->place == last ? block_size : one->place % block_size + 1;
      for (std::size_t lane = one->place % block_size; lane < end; ++lane) {
        block.x[lane] += one->move[0];
        block.y[lane] += one->move[1];
        block.z[lane] += one->move[2];
      }
    }
    shape.shape.set_stamp(block_number, BlockShape::new_stamp());
    shape.bounds[block_number] = bounds_of(block);
    for (const float side : shape.bounds[block_number].sides)
      shape.extent = std::max(shape.extent, std::abs(static_cast<double>(side)));
  }
  return true;
}

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
    const Way image = one.image < 0 ? way : way_of(one.image, from, to);
    changed = go(one, way, image, shape) || changed;
  }
  return changed;
}

bool BrushStroke::go(const OfPoint& one, const Way& way, const Way& image,
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
    const bool image_finds = one.image >= 0 && images_->find(dab_on(image, turns), shape);
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
